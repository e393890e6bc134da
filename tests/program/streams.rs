//! Standard output and standard error that are closed or full: no work is lost, and a result that could not be written is
//! a failure.

use std::process::Stdio;

use super::{bytes, command, folder, succeed};
use crate::gpu::fixture::need_device;

/// The other end of a stream.
#[derive(Clone, Copy, PartialEq, Debug)]
enum End {
    /// All goes well.
    Open,
    /// A pipe whose reader has gone.
    Closed,
    /// A full disk.
    Full,
}

impl End {
    fn stream(self) -> Stdio {
        match self {
            End::Open => Stdio::piped(),
            End::Closed => std::io::pipe().expect("a pipe").1.into(),
            End::Full => {
                std::fs::OpenOptions::new().write(true).open("/dev/full").expect("/dev/full").into()
            }
        }
    }
}

/// The exit code, and standard error if it is open.
fn run(folder: &std::path::Path, arguments: &[&str], out: End, err: End) -> (i32, String) {
    let child = command(folder, arguments)
        .env("RUST_LOG", "debug")
        .stdout(out.stream())
        .stderr(err.stream())
        .spawn();
    let output = child.and_then(|child| child.wait_with_output()).expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code().expect("an exit code"), said)
}

const BROKEN: [(End, End); 7] = [
    (End::Closed, End::Open),
    (End::Full, End::Open),
    (End::Open, End::Closed),
    (End::Open, End::Full),
    (End::Closed, End::Closed),
    (End::Full, End::Full),
    (End::Closed, End::Full),
];

#[test]
fn files_are_written_whoever_listens() {
    need_device();
    let folder = folder();
    let path = folder.path();
    std::fs::write(
        path.join("s.sculpt"),
        "new dims=16,16,16\nsubtract ellipsoid at=8,8,8 half=6\n",
    )
    .unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc", "--render", "a.png", "--size", "64x64"]);
    succeed(path, &["convert", "a.vsc", "a.pvm"]);
    succeed(path, &["marker", "--out", "a.svg"]);
    for (out, err) in BROKEN {
        for (arguments, made) in [
            (
                // With a device, so that there are plenty of log lines.
                &["run", "s.sculpt", "--out", "b.vsc", "--render", "b.png", "--size", "64x64"][..],
                &["vsc", "png"][..],
            ),
            (&["convert", "a.vsc", "b.pvm"], &["pvm"]),
            (&["marker", "--out", "b.svg"], &["svg"]),
        ] {
            let (code, said) = run(path, arguments, out, err);
            assert_eq!(code, 0, "{arguments:?} {out:?} {err:?}: {said}");
            for ending in made {
                let [a, b] = ["a", "b"].map(|name| path.join(format!("{name}.{ending}")));
                assert_eq!(bytes(a), bytes(b.clone()), "{arguments:?} {out:?} {err:?}");
                std::fs::remove_file(b).unwrap();
            }
        }
    }
}

#[test]
fn a_result_that_cannot_be_said_is_a_failure_and_a_reader_who_has_enough_is_none() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), "new dims=16,16,16\n").unwrap();
    std::fs::write(path.join("head.txt"), "0 0 0 0.6 0 0 0 1\n1000 0 0 0.5 0 0 0 1\n").unwrap();
    succeed(path, &["run", "s.sculpt", "--out", "a.vsc"]);
    for arguments in [
        &["info", "a.vsc"][..],
        &["commands"],
        &["doctor"],
        &["help"],
        &["render", "--help"],
        &["--version"],
        &["bench", "a.vsc", "--kernel", "ray"],
        &["track", "--from", "script:head.txt"],
    ] {
        for (out, err) in BROKEN {
            // It does not end while its output is read.
            if out == End::Open && arguments[0] == "track" {
                continue;
            }
            let (code, said) = run(path, arguments, out, err);
            let expected = i32::from(out == End::Full);
            assert_eq!(code, expected, "{arguments:?} {out:?} {err:?}: {said}");
            assert!(!said.contains("panicked"), "{said}");
            let by_clap = ["help", "--help", "--version"].contains(arguments.last().unwrap());
            if out == End::Full && err == End::Open && !by_clap {
                assert!(said.contains("standard output") && said.contains("space"), "{said}");
            }
        }
    }
}

#[test]
fn exit_codes_of_failures_are_the_same_when_nobody_hears_of_them() {
    let folder = folder();
    for (out, err) in BROKEN {
        for (arguments, expected) in [
            (&["info", "missing.vsc"][..], 3),
            (&["render", "--size", "0x0"], 2),
            (&["track", "--from", "none"], 2),
        ] {
            let (code, said) = run(folder.path(), arguments, out, err);
            assert_eq!(code, expected, "{arguments:?} {out:?} {err:?}: {said}");
        }
    }
}

#[test]
fn the_log_has_no_colours_in_a_pipe_and_only_warnings_unless_asked() {
    need_device();
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("s.sculpt"), "new dims=16,16,16\n").unwrap();
    // With a device, of which there is something to tell.
    let arguments =
        ["run", "s.sculpt", "--render", "a.png", "--size", "32x32", "--mode", "slicing"];
    let log = |filter: Option<&str>| {
        let mut program = command(path, &arguments);
        match filter {
            Some(filter) => program.env("RUST_LOG", filter),
            None => program.env_remove("RUST_LOG"),
        };
        let output = program.output().unwrap();
        assert!(output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let (usual, more) = (log(None), log(Some("virtual_sculpture=info")));
    assert!(!usual.contains("INFO") && !usual.contains('\x1b'), "{usual:?}");
    assert!(more.contains("INFO") && !more.contains('\x1b'), "{more:?}");
}

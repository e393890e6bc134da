//! Interfaces for other programs: commands through a pipe, facts as JSON, completions and manual pages.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use super::{command, fail, folder, picture, succeed};
use crate::gpu::fixture::need_device;

/// Runs `run -` with more arguments and this input. Returns exit code, answers and error output.
fn converse(folder: &Path, more: &[&str], input: &[u8]) -> (Option<i32>, Vec<Value>, String) {
    let mut command = command(folder, &[&["run", "-"], more].concat());
    let mut process = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    process.stdin.take().unwrap().write_all(input).unwrap();
    let output = process.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let answers = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    (output.status.code(), answers, String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn commands_are_executed_as_they_come_and_each_is_answered() {
    let folder = folder();
    let mut process = command(folder.path(), &["run", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = process.stdin.take().unwrap();
    let mut output = BufReader::new(process.stdout.take().unwrap());
    let mut ask = |line: &str| -> Value {
        writeln!(input, "{line}").unwrap();
        let mut answer = String::new();
        output.read_line(&mut answer).unwrap();
        serde_json::from_str(&answer).unwrap()
    };
    let new = ask("new dims=20,20,20 colour=24 fill=solid");
    assert_eq!((&new["ok"], &new["voxels"]), (&true.into(), &8000.into()));
    assert_eq!(ask("subtract cuboid at=10,10,20 half=10")["voxels"], 4000);
    let refused = ask("subtract cube at=1,2,3");
    assert!(refused["ok"] == false && refused["error"].as_str().unwrap().contains("cube"));
    assert_eq!(ask("undo")["voxels"], 8000);
    assert_eq!(ask("save \"a.vsc\"")["modified"], false);
    let file = ask("redo")["file"].as_str().map(str::to_owned);
    assert_eq!(file.as_deref(), Some("a.vsc"));
    assert!(folder.path().join("a.vsc").exists(), "saved when it was answered");
    drop(input);
    assert_eq!(process.wait().unwrap().code(), Some(3), "one command was refused");
}

#[test]
fn the_end_of_the_input_saves_and_renders() {
    need_device();
    let folder = folder();
    let more = ["--out", "b.vsc", "--render", "b.png", "--size", "64x48", "--mode", "ray"];
    let script = b"new dims=20,20,20 fill=solid\nsubtract cuboid at=0,0,0 half=8";
    let (code, answers, said) = converse(folder.path(), &more, script);
    assert_eq!((code, answers.len()), (Some(0), 2), "{said}");
    assert_eq!(picture(folder.path().join("b.png")).dimensions(), (64, 48));
    assert!(succeed(folder.path(), &["info", "b.vsc"]).contains("20x20x20"));
    let (code, answers, said) =
        converse(folder.path(), &["--in", "b.vsc"], b"nonsense\n\n# text\n");
    assert_eq!((code, answers.len()), (Some(3), 3));
    assert!(said.contains("1 of the commands"), "{said}");
    assert_eq!(answers[2]["voxels"], 8000 - 512);
    assert_eq!(converse(folder.path(), &[], b"").0, Some(0));
}

#[cfg(unix)]
#[test]
fn executed_commands_are_saved_if_the_reader_of_the_answers_goes_away() {
    use std::net::Shutdown;
    use std::os::fd::OwnedFd;
    use std::os::unix::net::UnixStream;

    let folder = folder();
    for (more, saved) in [(&["--out", "c.vsc"][..], true), (&[], false)] {
        let mut command = command(folder.path(), &[&["run", "-"], more].concat());
        // Not a pipe: a process that another thread has just forked would keep its reading end open for a while.
        let (answering, reading) = UnixStream::pair().unwrap();
        let mut process = command
            .stdin(Stdio::piped())
            .stdout(OwnedFd::from(answering))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The program alone holds that end: if it dies, the answers end.
        drop(command);
        let mut input = process.stdin.take().unwrap();
        let mut output = BufReader::new(reading);
        writeln!(input, "new dims=20,20,20 fill=solid\nsubtract cuboid at=10,10,20 half=10")
            .unwrap();
        let mut answers = String::new();
        (0..2).for_each(|_| assert!(output.read_line(&mut answers).unwrap() > 0));
        output.into_inner().shutdown(Shutdown::Both).unwrap();
        // It notices with the answer to the first line; there may be nobody for the others.
        let _ = writeln!(input, "# nothing\nclear\nclear");
        drop(input);
        let ended = process.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(1), "{said}");
        assert!(said.contains("nobody reads the answers") && said.contains("up to 3"), "{said}");
        assert_eq!(folder.path().join("c.vsc").exists(), saved);
        if saved {
            let (_, answers, _) = converse(folder.path(), &["--in", "c.vsc"], b"# again");
            assert_eq!(answers[0]["voxels"], 4000);
            std::fs::remove_file(folder.path().join("c.vsc")).unwrap();
        }
    }
}

#[test]
fn facts_of_files_are_json_if_asked_for() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("a.pvm"), b"PVM2\n2 2 1\n1 2 0.5\n1\n\x00\x09\xc8\xff").unwrap();
    let info: Value = serde_json::from_str(&succeed(path, &["info", "--json", "a.pvm"])).unwrap();
    assert_eq!(info["dims"], serde_json::json!([2, 2, 1]));
    assert_eq!(info["voxel_size"], serde_json::json!([1.0, 2.0, 0.5]));
    assert_eq!((&info["samples"], &info["bytes_per_voxel"]), (&"u8".into(), &1.into()));
    assert_eq!(info["densities"]["max"], 255.0);
    assert!(info["sculpture"].is_null() && info["texts"]["comment"].is_null());
    succeed(path, &["convert", "a.pvm", "a.vsc"]);
    let info: Value = serde_json::from_str(&succeed(path, &["info", "a.vsc", "--json"])).unwrap();
    assert_eq!(info["sculpture"]["colour_bits"], 24);
    assert!(info["densities"].is_null());
    fail(path, &["info", "--json", "missing.vsc"], 3);
}

#[test]
fn shells_and_man_know_all_commands() {
    let folder = folder();
    let path = folder.path();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = succeed(path, &["completions", shell]);
        assert!(script.contains("turntable") || script.contains("convert"), "{shell}");
        assert!(script.contains("--upright") || script.contains("upright"), "{shell}");
    }
    fail(path, &["completions", "tcsh"], 2);
    let page = succeed(path, &["man"]);
    assert!(page.contains(".TH virtual") && page.contains("convert"), "{page}");
    let page = succeed(path, &["man", "convert"]);
    assert!(page.contains("virtual") && page.contains("form"), "{page}");
    assert!(fail(path, &["man", "fly"], 2).contains("'fly'"));
    // They do not depend on settings, which may be wrong.
    std::fs::create_dir_all(path.join("virtual-sculpture")).unwrap();
    std::fs::write(path.join("virtual-sculpture/config.toml"), "nonsense = 1").unwrap();
    fail(path, &["info", "a.vsc"], 3);
    for help in [&["completions", "bash"][..], &["man"], &["commands"]] {
        assert!(!succeed(path, help).is_empty());
    }
}

/// The script for Python that the guide names.
#[test]
fn a_program_in_python_builds_a_stair() {
    if Command::new("python3").arg("--version").output().is_err() {
        trials::skip("there is no python3");
    }
    let folder = folder();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/drive.py");
    let output = Command::new("python3")
        .arg(script)
        .args([env!("CARGO_BIN_EXE_virtual-sculpture"), "stair \"1\".vsc"])
        .current_dir(folder.path())
        .env("XDG_CONFIG_HOME", folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("voxels"), "{said}");
    let info = succeed(folder.path(), &["info", "--json", "stair \"1\".vsc"]);
    assert!(info.contains("[96,128,96]"), "{info}");
}

//! Remains of killed sessions, and their recovery by `recover`.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use virtual_sculpture::document::Limits;
use virtual_sculpture::sculpture::Digest;
use virtual_sculpture::session::Session;

use super::{command, fail, folder, succeed};

/// The program with pipes; its state is in the folder.
fn with_state(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = command(folder, arguments);
    command.stdin(Stdio::piped());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Starts `run - --journal`.
fn start(folder: &Path) -> Child {
    with_state(folder, &["run", "-", "--journal"]).spawn().unwrap()
}

fn listed(folder: &Path) -> Vec<Value> {
    let output = with_state(folder, &["recover", "--json"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let Value::Array(listed) = serde_json::from_slice(&output.stdout).unwrap() else { panic!() };
    listed
}

/// Gives a session lines, one by one, and returns the last answer.
fn ask(session: &mut Child, lines: &[&str]) -> Value {
    let mut output = BufReader::new(session.stdout.take().unwrap());
    let input = session.stdin.as_mut().unwrap();
    let mut answer = String::new();
    for line in lines {
        writeln!(input, "{line}").unwrap();
        answer.clear();
        output.read_line(&mut answer).unwrap();
    }
    session.stdout = Some(output.into_inner());
    serde_json::from_str(&answer).unwrap()
}

fn kill(mut session: Child) {
    // On Unix this is SIGKILL.
    session.kill().unwrap();
    session.wait().unwrap();
}

fn digest_of(path: &Path) -> Digest {
    let session = Session::open(path, &Default::default(), Limits::default(), &()).unwrap();
    Digest::of(session.document().contents())
}

#[test]
fn nothing_left_is_nothing_listed() {
    let folder = folder();
    assert!(listed(folder.path()).is_empty());
    let output = with_state(folder.path(), &["recover"]).output().unwrap();
    assert!(output.status.success() && output.stdout.is_empty());
    let error = fail(folder.path(), &["recover", "7777777", "--discard"], 2);
    assert!(error.contains("no journal 7777777"), "{error}");
    let error = fail(folder.path(), &["recover", "7777777"], 2);
    assert!(error.contains("--out FILE"), "{error}");
}

#[test]
fn a_killed_session_is_listed_written_and_discarded() {
    let folder = folder();
    let path = folder.path();
    let mut session = start(path);
    let lines = ["new dims=20,20,20 colour=24", "subtract cuboid at=10,10,20 half=10", "begin"];
    assert_eq!(ask(&mut session, &lines)["voxels"], 4000);
    let within = ask(&mut session, &["subtract cuboid at=10,10,0 half=2"])["voxels"].clone();
    assert!(listed(path).is_empty(), "it belongs to a session that runs");
    let discard = || with_state(path, &["recover", "1", "--discard"]).output().unwrap();
    let refused = discard();
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("still running"));
    kill(session);

    let left = listed(path);
    assert_eq!(left.len(), 1);
    assert_eq!((&left[0]["number"], &left[0]["voxels"]), (&1.into(), &within));
    assert_eq!(
        (&left[0]["dims"], &left[0]["steps"]),
        (&serde_json::json!([20, 20, 20]), &3.into())
    );
    let text = with_state(path, &["recover"]).output().unwrap();
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.starts_with("1: a new sculpture, 2") && text.contains("3 steps"), "{text}");

    std::fs::write(path.join("mine.vsc"), "mine").unwrap();
    let write = |name: &str| {
        with_state(path, &["recover", "1", "--out", name, "--discard"]).output().unwrap()
    };
    let refused = write("mine.vsc");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("overwrites nothing"));
    assert_eq!(std::fs::read(path.join("mine.vsc")).unwrap(), b"mine");
    let written = write("back.vsc");
    assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    let back =
        Session::open(&path.join("back.vsc"), &Default::default(), Limits::default(), &()).unwrap();
    assert_eq!(Value::from(back.document().grid().opaque_count()), within);
    assert!(listed(path).is_empty(), "it was discarded after it was written");
}

/// Times are for reading only: those of a clock that was set back, or runs ahead, change nothing else.
#[test]
fn a_clock_that_is_wrong_does_no_harm() {
    let folder = folder();
    let path = folder.path();
    let times = [0, 1, 60 * 365 * 86_400, 200 * 365 * 86_400].map(Duration::from_secs);
    for _ in times {
        let mut session = start(path);
        ask(&mut session, &["new dims=9,9,9", "clear"]);
        kill(session);
    }
    for (i, time) in times.into_iter().enumerate() {
        let journal = path.join(format!("virtual-sculpture/journals/{}.journal", i + 1));
        let file = std::fs::File::options().append(true).open(journal).unwrap();
        file.set_modified(std::time::UNIX_EPOCH + time).unwrap();
    }
    let left = listed(path);
    assert_eq!(left.iter().map(|left| left["number"].clone()).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert!(left.iter().all(|left| left["voxels"] == 0 && left["untouched"] == false), "{left:?}");
    // A session that begins now takes another number, and the others come back.
    let mut session = start(path);
    ask(&mut session, &["clear"]);
    kill(session);
    assert_eq!(listed(path).len(), 5);
    for number in 1..=4 {
        let (number, out) = (number.to_string(), format!("{number}.vsc"));
        succeed(path, &["recover", &number, "--out", &out, "--discard"]);
    }
    assert_eq!(listed(path).len(), 1);
}

#[test]
fn a_session_that_ends_as_it_should_leaves_only_what_is_not_saved() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("a.sculpt"), "new dims=9,9,9\nclear\n").unwrap();
    let run = |more: &[&str]| {
        let arguments = [&["run", "a.sculpt", "--journal"], more].concat();
        let output = with_state(path, &arguments).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let told = run(&["--out", "a.vsc"]);
    assert!(!told.contains("journal") && listed(path).is_empty(), "{told}");
    let told = run(&[]);
    assert!(told.contains("recover 1 --out"), "{told}");
    assert_eq!(listed(path).len(), 1);
    // Without the option a script leaves nothing: it can be run again.
    succeed(path, &["run", "a.sculpt"]);
    assert_eq!(listed(path).len(), 1);
}

/// A signal ends the program as a kill does: nothing that was answered is lost.
#[cfg(unix)]
#[test]
fn signals_that_end_the_program_lose_nothing() {
    for signal in crate::signals::heeded() {
        let folder = folder();
        let mut session = start(folder.path());
        let voxels = ask(&mut session, &["new dims=20,20,20", "clear", "undo"])["voxels"].clone();
        let sent = Command::new("kill").args([signal, &session.id().to_string()]).status();
        assert!(sent.unwrap().success());
        assert!(!session.wait().unwrap().success(), "{signal}");
        let left = listed(folder.path());
        assert_eq!((left.len(), &left[0]["voxels"]), (1, &voxels), "{signal}");
    }
}

#[test]
fn a_fault_without_a_window_loses_nothing_and_says_where_it_is() {
    let folder = folder();
    let path = folder.path();
    let lines =
        ["new dims=16,16,16", "subtract cuboid at=8,8,8 half=2", "subtract cuboid at=4,4,4 half=1"];
    let mut session =
        with_state(path, &["run", "-", "--journal"]).env("VS_PANIC_AT", "3").spawn().unwrap();
    assert_eq!(ask(&mut session, &lines[..2])["ok"], true);
    writeln!(session.stdin.as_mut().unwrap(), "{}", lines[2]).unwrap();
    let output = session.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(101), "{text}");
    assert!(text.contains("VS_PANIC_AT asked for it") && text.contains("1.journal"), "{text}");
    assert_eq!(listed(path).len(), 1);
    succeed(path, &["recover", "1", "--out", "again.vsc"]);

    let new = virtual_sculpture::config::Config::default().new_sculpture();
    let mut expected = Session::new(&new, Limits::default()).unwrap();
    for line in lines {
        expected.execute(&line.parse().unwrap(), &()).unwrap();
    }
    assert_eq!(digest_of(&path.join("again.vsc")), Digest::of(expected.document().contents()));
}

#[test]
fn a_state_folder_that_cannot_be_is_told_and_stops_nothing() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("virtual-sculpture"), "a file where the folder should be").unwrap();
    std::fs::write(path.join("a.sculpt"), "new dims=9,9,9\nclear\n").unwrap();
    let run = with_state(path, &["run", "a.sculpt", "--journal"]).output().unwrap();
    let told = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(run.status.success() && told.contains("work goes on"), "{told}");
}

#[test]
fn an_embedded_file_is_opened_whatever_its_name_says() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("a.sculpt"), "new dims=9,9,9\nsave \"a.vsc\"\n").unwrap();
    succeed(path, &["run", "a.sculpt"]);
    let file = std::fs::read(path.join("a.vsc")).unwrap();
    let data = virtual_sculpture::format::base64::encode(&file);
    let script = format!("embed \"/nowhere/b.nii\" data={data}\nopen \"/nowhere/b.nii\"\n");
    std::fs::write(path.join("b.sculpt"), script).unwrap();
    succeed(path, &["run", "b.sculpt", "--out", "b.vsc"]);
    assert_eq!(digest_of(&path.join("b.vsc")), digest_of(&path.join("a.vsc")));
}

#[test]
fn a_recorded_script_has_the_hash_of_the_session_without_its_files() {
    let folder = folder();
    let path = folder.path();
    let new = "new dims=20,20,20 colour=24".parse().unwrap();
    let virtual_sculpture::command::Command::New(new) = new else { panic!() };
    let mut session = Session::new(&new, Limits::default()).unwrap();
    let picture = path.join("a.png");
    image::RgbImage::from_fn(3, 3, |x, y| image::Rgb([(x * 80) as u8, (y * 80) as u8, 9]))
        .save(&picture)
        .unwrap();
    session.record_to(&path.join("made.sculpt")).unwrap();
    let own = path.join("own.vsc");
    for line in [
        "subtract ellipsoid at=9,9,18 half=8".to_string(),
        format!("save {own:?}"),
        "clear".to_string(),
        format!("open {own:?}"),
        format!("texture {picture:?} cuboid at=9,9,3 half=6"),
        "undo 2".to_string(),
        "redo 2".to_string(),
    ] {
        session.execute(&line.parse().unwrap(), &()).unwrap();
    }
    std::fs::remove_file(&picture).unwrap();
    std::fs::remove_file(&own).unwrap();
    let output = with_state(path, &["run", "made.sculpt", "--hash", "--quiet"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let scene = format!("scene {}", Digest::of(session.document().contents()));
    assert!(output.status.success() && text.contains(&scene), "{text}");
    assert!(!own.exists(), "a replay writes no file");
}

#[test]
fn a_script_has_the_same_hashes_whatever_the_number_of_threads() {
    let folder = folder();
    let path = folder.path();
    let script = "new dims=60,50,40 colour=24\nsubtract ellipsoid at=9,9,9 half=20\nfill-cavities\n\
                  recolour cuboid at=30,30,39 half=9 colour=#c04010\nremove-islands\nthicken to=2\n";
    std::fs::write(path.join("a.sculpt"), script).unwrap();
    let hashes = |script: &str, threads: &str| {
        let mut run = with_state(path, &["run", script, "--hash", "--quiet"]);
        let output = run.env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let one = hashes("a.sculpt", "1");
    let lines: Vec<&str> = one.lines().rev().take(2).collect();
    assert!(lines[0].starts_with("picture ") && lines[1].starts_with("scene "), "{one}");
    assert!(lines.iter().all(|line| line.rsplit(' ').next().unwrap().len() == 64), "{one}");
    assert_eq!(hashes("a.sculpt", "4"), one);
    std::fs::write(path.join("b.sculpt"), format!("{script}subtract cuboid at=30,49,20 half=1"))
        .unwrap();
    let other = hashes("b.sculpt", "2");
    let is_hash = |line: &&str| line.starts_with("scene ") || line.starts_with("picture ");
    let both = one.lines().filter(is_hash).zip(other.lines().filter(is_hash));
    assert_eq!(both.filter(|(a, b)| a != b).count(), 2);
}

#[test]
fn a_damaged_journal_is_reported() {
    let folder = folder();
    let path = folder.path();
    let journal_dir = path.join("virtual-sculpture/journals");
    std::fs::create_dir_all(&journal_dir).unwrap();
    std::fs::write(journal_dir.join("4.journal"), "no journal").unwrap();
    let left = listed(path);
    assert!(left[0]["number"] == 4 && left[0]["error"].as_str().unwrap().contains("no journal"));
    let output = with_state(path, &["recover", "4", "--out", "a.vsc"]).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(!path.join("a.vsc").exists());
}

/// Numbers from a seed, as xorshift64 makes them.
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end
    }
}

/// A line of work on a sculpture of 40 voxels, in and out of strokes.
fn line(random: &mut Random) -> String {
    let at = [0; 3].map(|_: u8| random.below(40));
    let [x, y, z] = at;
    let half = 1 + random.below(9);
    match random.below(16) {
        0..5 => format!("subtract ellipsoid at={x},{y},{z} half={half}"),
        5..8 => {
            format!("add cuboid at={x},{y},{z} half={half} colour=#{:06x}", random.below(1 << 24))
        }
        8 | 9 => format!("recolour ellipsoid at={x},{y},{z} half={half} colour=#80{x:02x}{y:02x}"),
        10 => "begin \"stroke\"".to_string(),
        11 => "end".to_string(),
        12 => format!("undo {}", 1 + random.below(4)),
        13 => format!("redo {}", 1 + random.below(3)),
        14 => "orient axes=y,-z,x".to_string(),
        _ => "fill colour=#405060".to_string(),
    }
}

/// Kills sessions at random moments, `VS_KILLS` of them or a few: all that was answered is there, and what is there
/// is a state that the session had.
#[test]
fn after_a_kill_at_any_moment_all_that_was_answered_is_there() {
    let kills = std::env::var("VS_KILLS").map_or(6, |kills| kills.parse().unwrap());
    let seed = std::process::id() as u64;
    let (mut recovered, mut within) = (0, 0);
    for kill in 0..kills {
        let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ (seed << 20) ^ (kill + 1));
        let lines: Vec<String> = (0..400).map(|_| line(&mut random)).collect();
        let folder = folder();
        let path = folder.path();
        let mut session = start(path);
        let mut input = session.stdin.take().unwrap();
        let output = session.stdout.take().unwrap();
        let text = format!("new dims=40,40,40 colour=24\n{}\n", lines.join("\n"));
        let writer = std::thread::spawn(move || {
            // The pipe breaks when the session is killed; it stays open until then.
            let _ = input.write_all(text.as_bytes());
            input
        });
        let answered = std::thread::spawn(move || BufReader::new(output).lines().count());
        std::thread::sleep(Duration::from_micros(random.below(150_000)));
        self::kill(session);
        drop(writer.join());
        let answered = answered.join().unwrap();

        let left = listed(path);
        let name = format!("kill {kill} of process {seed}, {answered} answers");
        assert!(!left.is_empty() || answered == 0, "{name}");
        if left.is_empty() {
            continue;
        }
        assert_eq!(left[0]["error"], Value::Null, "{name}");
        let out = ["recover", "1", "--out", "back.vsc"];
        let output = with_state(path, &out).output().unwrap();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let back = digest_of(&path.join("back.vsc"));

        // The states that the session went through.
        let new = "new dims=256,256,256 colour=24".parse().unwrap();
        let virtual_sculpture::command::Command::New(new) = new else { panic!() };
        let mut model = Session::new(&new, Limits::default()).unwrap();
        let first = "new dims=40,40,40 colour=24".to_string();
        let mut at = None;
        for (i, line) in std::iter::once(&first).chain(&lines).enumerate() {
            // Undo and redo of several steps may be cut between two of them.
            let (verb, steps) = line.split_once(' ').unwrap_or((line, ""));
            let single = ["undo", "redo"].contains(&verb);
            let count = if single { steps.parse().unwrap() } else { 1 };
            let command = if single { format!("{verb} 1") } else { line.clone() };
            for _ in 0..count {
                let _ = model.execute(&command.parse().unwrap(), &());
                if i + 1 >= answered && Digest::of(model.document().contents()) == back {
                    at = at.or(Some(i));
                }
            }
            if at.is_some() {
                break;
            }
        }
        assert!(at.is_some() || answered == 0, "{name}: not a state from the last answer on");
        recovered += 1;
        within += usize::from(model.document().stroke_open());
    }
    println!(
        "{recovered} of {kills} killed sessions had begun a journal, {within} were in a stroke"
    );
}

#[test]
fn undo_goes_on_in_another_process_if_that_is_asked_for() {
    let folder = folder();
    let path = folder.path();
    let run = |more: &[&str], lines: &str| -> Vec<Value> {
        let mut session = with_state(path, &[&["run", "-"], more].concat()).spawn().unwrap();
        session.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
        let output = session.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let made = run(
        &["--history", "--out", "b.vsc"],
        "new dims=20,20,20 fill=solid\nsubtract cuboid at=10,10,20 half=10\nsave \"a.vsc\"\nclear",
    );
    let first = run(&["--history"], "open \"a.vsc\"\nundo 1\nundo 1\nredo all");
    assert_eq!((&first[0]["voxels"], &first[1]["voxels"]), (&made[1]["voxels"], &8000.into()));
    assert_eq!((&first[3]["voxels"], &first[3]["modified"]), (&4000.into(), &false.into()));
    // The last saves, in turn; the first file keeps its own.
    let last = run(&["--history", "--in", "b.vsc"], "undo 1\nundo 1");
    assert_eq!((&last[0]["voxels"], &last[1]["voxels"]), (&4000.into(), &8000.into()));
    // A script that does not ask for it does the same everywhere.
    let plain = run(&["--in", "b.vsc"], "undo 1");
    assert_eq!((&plain[0]["voxels"], &plain[0]["steps"]), (&0.into(), &0.into()));
}

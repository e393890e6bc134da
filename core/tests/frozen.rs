//! Tests that files written in November 2026 still have the same contents: a script, the text of its commands, a
//! journal with and without a checkpoint, a sculpture and its undo history.
//!
//! `VS_FREEZE=1` writes missing files; existing ones are never overwritten. On other systems than the one that wrote
//! them, sines may differ in the last bit, and with them a voxel.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use sculpture_core::command::Command;
use sculpture_core::command::text::parse_script;
use sculpture_core::document::Limits;
use sculpture_core::persist::frame::Ending;
use sculpture_core::persist::journal::JournalOptions;
use sculpture_core::sculpture::Digest;
use sculpture_core::session::Session;

use crate::journal::memory::Memory;
use crate::journal::{all_of, assert_same, options, recovered};
use crate::saved_history::in_memory;

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/frozen").join(name)
}

/// Returns a frozen file; `made` if it is being frozen now.
fn frozen(name: &str, made: impl FnOnce() -> Vec<u8>) -> Vec<u8> {
    let path = path(name);
    if !path.exists() && std::env::var_os("VS_FREEZE").is_some_and(|on| on == "1") {
        std::fs::write(&path, made()).unwrap();
    }
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn frozen_text(name: &str, made: impl FnOnce() -> String) -> String {
    String::from_utf8(frozen(name, || made().into_bytes())).unwrap()
}

fn script() -> Vec<Command> {
    script_of("commands.sculpt")
}

/// Returns the script of a canvas that is moved and grows.
fn canvas_script() -> Vec<Command> {
    script_of("canvas.sculpt")
}

fn script_of(name: &str) -> Vec<Command> {
    let text = std::fs::read_to_string(path(name)).unwrap();
    parse_script(&text).unwrap().into_iter().map(|(_, command)| command).collect()
}

fn session() -> Session {
    let new: Command = "new dims=9,9,9".parse().unwrap();
    let Command::New(new) = new else { panic!() };
    Session::new(&new, Limits::default()).unwrap()
}

fn execute(session: &mut Session, command: &Command) {
    session.execute(command, &()).unwrap_or_else(|error| panic!("{command}: {error}"));
}

fn digest(session: &Session) -> String {
    let Digest(bytes) = Digest::of(session.document().contents());
    bytes[..8].iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap();
        text
    })
}

/// Returns the image of the script, and its last sculptures: with copies, symmetry, orientations, repairs, a mask.
fn end_of_script() -> Vec<Command> {
    let all = script();
    let new = (0..all.len()).rev().filter(|i| matches!(all[*i], Command::New(_)));
    let start = new.take(4).last().unwrap();
    all[..1].iter().chain(&all[start..]).cloned().collect()
}

/// Returns a few steps that change bits, colours and the mask.
fn few_steps() -> Vec<Command> {
    let lines = [
        "new dims=24,20,17 size=1,1,1 colour=24 base=#c8beaa fill=solid",
        "subtract ellipsoid at=12,10,8 half=6",
        "recolour ellipsoid at=12,10,8 half=9 colour=#408060",
        "mask add ellipsoid at=4,10,8 half=6",
        "noise colour=#204060 size=8 amount=1",
        "clear",
        "undo",
    ];
    lines.map(|line| line.parse().unwrap()).into()
}

fn done(commands: &[Command]) -> Session {
    let mut session = session();
    commands.iter().for_each(|command| execute(&mut session, command));
    session
}

#[test]
fn every_command_keeps_its_text_and_makes_the_same_sculpture() {
    keeps_its_text("commands.txt", &script());
    keeps_its_text("canvas.txt", &canvas_script());
}

fn keeps_its_text(name: &str, script: &[Command]) {
    let mut session = session();
    let mut now = String::new();
    for command in script {
        execute(&mut session, command);
        writeln!(now, "{} {command}", digest(&session)).unwrap();
    }
    let then = frozen_text(name, || now.clone());
    for (i, (now, then)) in now.lines().zip(then.lines()).enumerate() {
        assert_eq!(now, then, "command {i}");
    }
    assert_eq!(now.lines().count(), then.lines().count());
    // The written text reads back as the same commands.
    let texts =
        then.lines().map(|line| line.split_once(' ').unwrap().1.parse::<Command>().unwrap());
    assert!(texts.eq(script.iter().cloned()));
}

#[test]
fn the_script_has_every_command() {
    let commands = [script(), canvas_script()].concat();
    for verb in sculpture_core::command::COMMANDS.iter().map(|help| help.verb) {
        // Files have tests of their own.
        let is_there = commands.iter().any(|command| command.verb() == verb);
        assert!(is_there || ["open", "save"].contains(&verb), "{verb}");
    }
}

#[test]
fn a_journal_leads_to_the_same_session() {
    let cases = [
        ("steps.journal", 1000, script()),
        ("checkpoint.journal", 0, end_of_script()),
        ("pages.journal", 0, few_steps()),
        ("canvas.journal", 1000, canvas_script()),
        ("canvas-checkpoint.journal", 0, canvas_script()),
    ];
    for (name, replay, commands) in cases {
        let bytes = frozen(name, || {
            let memory = Memory::default();
            let replay = Duration::from_secs(replay);
            let mut session = session();
            session.keep_journal(JournalOptions { replay, ..options(&memory) }).unwrap();
            for command in &commands {
                execute(&mut session, command);
                session.wait_for_journal();
            }
            memory.only_file().1
        });
        let again = recovered(&Memory::with_journal(&bytes)).unwrap();
        assert_eq!(
            (&again.report.difference, again.report.ending),
            (&None, Ending::Whole),
            "{name}"
        );
        assert_same(&all_of(&again.session), &all_of(&done(&commands)));
    }
}

#[test]
fn a_sculpture_comes_back_with_its_undo_history() {
    let mut memory = Memory::default();
    let file = frozen("sculpture.vsc", || {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sculpture.vsc");
        let mut session = session();
        session.keep_saved_histories(in_memory(&memory));
        end_of_script().iter().for_each(|command| execute(&mut session, command));
        session.execute(&format!("save {path:?}").parse().unwrap(), &()).unwrap();
        session.wait_for_saved_history();
        std::fs::read(&path).unwrap()
    });
    let history = frozen("sculpture.history", || memory.only_file().1);
    let name = frozen_text("history-name.txt", || memory.only_file().0.display().to_string());
    memory = Memory::with_file(name.as_ref(), &history);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sculpture.vsc");
    std::fs::write(&path, file).unwrap();
    let mut again = crate::saved_history::reopen(&path, in_memory(&memory));
    assert_eq!(again.take_history_message(), None);
    let mut expected = done(&end_of_script());
    let mut undone = 0;
    loop {
        assert_eq!(digest(&again), digest(&expected), "{undone} steps undone");
        let [one, other] = [&mut again, &mut expected].map(|session| {
            let label = session.document().history().undo_labels().last().map(String::from);
            (label, session.execute(&"undo 1".parse().unwrap(), &()).unwrap().steps)
        });
        assert_eq!(one, other, "{undone} steps undone");
        if one.1 == 0 {
            break;
        }
        undone += 1;
    }
    assert!(undone > 40, "{undone}");
}

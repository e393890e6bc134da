//! Sessions compared with a model of the file of each state, under random opening, saving, editing, undo and redo.

use std::path::{Path, PathBuf};

use glam::{IVec3, UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::Limits;
use sculpture_core::format;
use sculpture_core::sculpture::{ColourDepth, Rgb};
use sculpture_core::session::Session;

const FILES: usize = 3;

#[derive(Clone, Copy, Debug)]
enum Operation {
    New,
    Open(usize),
    Save(usize),
    /// Toggles a voxel.
    Edit(UVec3),
    /// Toggles a voxel within a stroke that is ended (true) or cancelled.
    Stroke(UVec3, bool),
    Undo(u32),
    Redo(u32),
}

fn operation() -> impl Strategy<Value = Operation> {
    let voxel = || prop::array::uniform3(0u32..8).prop_map(UVec3::from);
    prop_oneof![
        1 => Just(Operation::New),
        3 => (0..FILES).prop_map(Operation::Open),
        4 => (0..FILES).prop_map(Operation::Save),
        5 => voxel().prop_map(Operation::Edit),
        2 => (voxel(), any::<bool>()).prop_map(|(at, ends)| Operation::Stroke(at, ends)),
        5 => (1u32..4).prop_map(Operation::Undo),
        4 => (1u32..4).prop_map(Operation::Redo),
    ]
}

#[derive(Clone, Default)]
struct Sculpture {
    path: Option<usize>,
    /// The version that it was created with, as long as it has never had a file.
    untouched: Option<u32>,
}

/// The contents of files and history, as version numbers.
struct Model {
    disk: [u32; FILES],
    versions: u32,
    sculptures: Vec<Sculpture>,
    /// Version and sculpture of each state, in the order of the history.
    states: Vec<(u32, usize)>,
    at: usize,
}

impl Model {
    fn push(&mut self, version: u32, sculpture: usize) {
        self.states.truncate(self.at + 1);
        self.states.push((version, sculpture));
        self.at += 1;
    }

    fn version(&mut self) -> u32 {
        self.versions += 1;
        self.versions
    }

    fn apply(&mut self, operation: Operation) {
        let (version, sculpture) = self.states[self.at];
        match operation {
            Operation::New => {
                let made = self.version();
                self.sculptures.push(Sculpture { path: None, untouched: Some(made) });
                self.push(made, self.sculptures.len() - 1);
            }
            Operation::Open(file) => {
                self.sculptures.push(Sculpture { path: Some(file), untouched: None });
                self.push(self.disk[file], self.sculptures.len() - 1);
            }
            Operation::Save(file) => {
                self.disk[file] = version;
                for other in &mut self.sculptures {
                    if other.path == Some(file) {
                        *other = Sculpture::default();
                    }
                }
                self.sculptures[sculpture] = Sculpture { path: Some(file), untouched: None };
            }
            Operation::Edit(_) | Operation::Stroke(_, true) => {
                let made = self.version();
                self.push(made, sculpture);
            }
            Operation::Stroke(_, false) => {}
            Operation::Undo(steps) => self.at = self.at.saturating_sub(steps as usize),
            Operation::Redo(steps) => {
                self.at = (self.at + steps as usize).min(self.states.len() - 1)
            }
        }
    }

    fn path(&self) -> Option<usize> {
        self.sculptures[self.states[self.at].1].path
    }

    fn is_saved(&self) -> bool {
        let (version, sculpture) = self.states[self.at];
        let Sculpture { path, untouched } = self.sculptures[sculpture];
        path.is_some_and(|file| self.disk[file] == version) || untouched == Some(version)
    }
}

fn new() -> NewSculpture {
    NewSculpture {
        room_vx: 0,
        grows: false,
        dims: UVec3::splat(8),
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::None,
        base: Rgb::STONE,
        solid: true,
    }
}

fn toggle(session: &mut Session, at: UVec3) {
    let verb = if session.document().grid().get(at.as_ivec3()) { "subtract" } else { "add" };
    let centre = at.as_vec3() + 0.5;
    let line = format!(
        "{verb} cuboid at={},{},{} half=0.5{}",
        centre.x,
        centre.y,
        centre.z,
        if verb == "add" { " colour=#c8beaa" } else { "" }
    );
    let applied = session.execute(&line.parse().unwrap(), &()).unwrap();
    assert_eq!(applied.stats.voxels_changed(), 1);
}

fn execute(session: &mut Session, line: &str) {
    session.execute(&line.parse().unwrap(), &()).unwrap_or_else(|e| panic!("{line}: {e}"));
}

fn perform(session: &mut Session, operation: Operation, paths: &[PathBuf]) {
    match operation {
        Operation::New => drop(session.execute(&Command::New(new()), &()).unwrap()),
        Operation::Open(file) => execute(session, &format!("open {:?}", paths[file])),
        Operation::Save(file) => execute(session, &format!("save {:?}", paths[file])),
        Operation::Edit(at) => toggle(session, at),
        Operation::Stroke(at, ends) => {
            execute(session, "begin");
            toggle(session, at);
            assert!(session.modified(), "the changes of a stroke are in no file yet");
            execute(session, if ends { "end" } else { "cancel" });
        }
        Operation::Undo(steps) => execute(session, &format!("undo {steps}")),
        Operation::Redo(steps) => execute(session, &format!("redo {steps}")),
    }
}

fn write_files(folder: &Path) -> Vec<PathBuf> {
    let paths: Vec<PathBuf> = (0..FILES).map(|i| folder.join(format!("{i}.vsc"))).collect();
    for (i, path) in paths.iter().enumerate() {
        let mut session = Session::new(&new(), Limits::default()).unwrap();
        toggle(&mut session, UVec3::new(i as u32, 7, 7));
        execute(&mut session, &format!("save {path:?}"));
    }
    paths
}

proptest! {
    #[test]
    fn undo_restores_file_and_saved_state(
        operations in prop::collection::vec(operation(), 1..60),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let paths = write_files(folder.path());
        let mut session = Session::new(&new(), Limits::default()).unwrap();
        let mut model = Model {
            disk: [1, 2, 3],
            versions: 4,
            sculptures: vec![Sculpture { path: None, untouched: Some(4) }],
            states: vec![(4, 0)],
            at: 0,
        };
        for (i, operation) in operations.iter().enumerate() {
            perform(&mut session, *operation, &paths);
            model.apply(*operation);
            let path = model.path().map(|file| paths[file].as_path());
            prop_assert_eq!(session.path(), path, "after {} of {:?}", i, operations);
            prop_assert_eq!(session.modified(), !model.is_saved(), "after {} of {:?}", i, operations);
            if let (Some(path), false) = (session.path(), session.modified()) {
                let file = format::load(path, &Default::default(), &Limits::default(), &()).unwrap();
                prop_assert_eq!(&file.contents, session.document().contents());
            }
        }
    }
}

/// The script that revealed the defect.
#[test]
fn undo_past_open_brings_back_the_other_file() {
    let folder = tempfile::tempdir().unwrap();
    let paths = write_files(folder.path());
    let [a, b] = [&paths[0], &paths[1]];
    let mut session = Session::open(a, &Default::default(), Limits::default(), &()).unwrap();
    execute(&mut session, &format!("open {b:?}"));
    toggle(&mut session, UVec3::new(1, 1, 1));
    execute(&mut session, &format!("save {b:?}"));
    execute(&mut session, "undo 2");
    assert_eq!(session.path(), Some(a.as_path()));
    assert!(!session.modified());
    execute(&mut session, "redo 2");
    assert_eq!(session.path(), Some(b.as_path()));
    assert!(!session.modified(), "this is the saved state");
    assert!(!session.document().grid().get(IVec3::ONE));
}

/// Texts belong to the sculpture with which they were loaded.
#[test]
fn undo_past_open_brings_back_the_texts_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let (described, plain) = (folder.path().join("described.vsc"), folder.path().join("plain.vsc"));
    let session = Session::new(&new(), Limits::default()).unwrap();
    let texts = format::Texts { description: b"a lake".to_vec(), ..Default::default() };
    let contents = session.document().contents();
    let (plain_form, limits) = (Default::default(), Limits::default());
    format::save_with(&described, contents, &plain_form, texts, &limits, &()).unwrap();
    format::save(&plain, contents, Default::default(), &()).unwrap();
    let mut session =
        Session::open(&described, &Default::default(), Limits::default(), &()).unwrap();
    execute(&mut session, &format!("open {plain:?}"));
    execute(&mut session, "undo");
    let again = folder.path().join("again.vsc");
    execute(&mut session, &format!("save {again:?}"));
    assert_eq!(format::info(&again).unwrap().texts.description, b"a lake");
}

/// The script's options for a mesh are applied, reported and recorded; other formats ignore them.
#[test]
fn a_mesh_is_saved_as_its_command_says() {
    let folder = tempfile::tempdir().unwrap();
    let [mesh, volume] = ["a.stl", "a.pvm"].map(|name| folder.path().join(name));
    let mut session = Session::new(&new(), Limits::default()).unwrap();
    execute(&mut session, "new dims=6,4,2 fill=solid");
    let line = format!("save {mesh:?} mesh=greedy up=y millimetres=0.5");
    execute(&mut session, &line);
    assert_eq!(session.take_notes(), ["12 triangles, 8 vertices, 3.0x2.0x1.0 mm"]);
    let command: Command = line.parse().unwrap();
    assert_eq!(command.to_string(), line);
    let refused: Command = format!("save {volume:?} mesh=greedy").parse().unwrap();
    let error = session.execute(&refused, &()).unwrap_err().to_string();
    assert!(error.contains("a.pvm") && !volume.exists(), "{error}");
    for (wrong, reason) in
        [("mesh=round", "faces, greedy, smooth"), ("triangles=-3", "not a valid number")]
    {
        let error = format!("save a.stl {wrong}").parse::<Command>().unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
}

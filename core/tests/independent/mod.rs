//! Random scripts, executed by the library and by a model that was written independently of it: from the manual only,
//! with an array of voxels, `f64`, and none of the library's code. After each command, every voxel, its colour and its
//! protection are compared, and whether the command was refused.
//!
//! `SCULPTURE_SCRIPTS` sets the number of scripts (default 200), `SCULPTURE_SCRIPTS_FROM` the first seed.

mod execute;
mod generator;
mod mask;
mod matrix;
mod model;
mod orient;
mod random;
mod rays;
mod solid;
mod statement;
mod sweep;
mod symmetry;

use glam::{IVec3, UVec3, Vec3};
use sculpture_core::command::text::parse_script;
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::{ColourDepth, Rgb};

use generator::Generator;
use model::Model;
use random::Random;

fn number(name: &str, default: u64) -> u64 {
    match std::env::var(name) {
        Ok(text) => text.parse().unwrap_or_else(|_| panic!("{name}={text} is no number")),
        Err(_) => default,
    }
}

/// Returns a description of the first voxel in which the two differ.
fn difference(document: &Document, model: &Model) -> Option<String> {
    let sculpture = model.now();
    let [x, y, z] = sculpture.dims;
    if document.grid().dims() != UVec3::new(x as u32, y as u32, z as u32) {
        return Some(format!(
            "{:?} voxels, the model {:?}",
            document.grid().dims(),
            sculpture.dims
        ));
    }
    for (i, colour) in sculpture.voxels.iter().enumerate() {
        let v = IVec3::new((i % x) as i32, (i / x % y) as i32, (i / x / y) as i32);
        let here = document.contents().colour(v).map(|colour| colour.0);
        if here != *colour {
            return Some(format!("voxel {v}: {here:?}, the model {colour:?}"));
        }
        let (masked, expected) = (document.mask().is_some_and(|m| m.get(v)), sculpture.masked[i]);
        if masked != expected {
            return Some(format!("voxel {v}: protected {masked}, the model {expected}"));
        }
    }
    None
}

/// Runs one script in both. Returns how many of its commands were accepted.
fn agree(seed: u64, used: &mut std::collections::BTreeMap<&'static str, u64>) -> u64 {
    // The first command of each script replaces it.
    let placeholder = NewSculpture {
        dims: UVec3::ONE,
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::None,
        base: Rgb::STONE,
        solid: true,
        room_vx: 0,
        grows: false,
    };
    let mut document = Document::new(&placeholder, Limits::default()).unwrap();
    let mut random = Random::new(seed);
    let mut model = Model::new();
    let mut script = String::new();
    let mut done = 0;
    let length = 10 + random.below(40);
    for line in 0..length {
        let statement = Generator { random: &mut random, model: &model }.statement(line == 0);
        let text = statement.to_string();
        script += &format!("{text}\n");
        let (_, command): (usize, Command) = match parse_script(&text) {
            Ok(mut read) => read.remove(0),
            Err(error) => panic!("script {seed}: {text}: {error}"),
        };
        let expected = model.execute(&statement);
        let result = document.apply(&command);
        if result.is_ok() != expected {
            panic!("script {seed}: {text}\n{result:?}, the model: {expected}\n\n{script}");
        }
        if let Some(difference) = difference(&document, &model) {
            panic!("script {seed}, after {text}\n{difference}\n\n{script}");
        }
        if expected {
            done += 1;
            *used.entry(command.verb()).or_default() += 1;
            for form in generator::FORMS.into_iter().filter(|form| text.contains(form)) {
                *used.entry(form).or_default() += 1;
            }
        }
    }
    done
}

#[test]
fn random_scripts_equal_the_independent_model() {
    let (count, first) = (number("SCULPTURE_SCRIPTS", 200), number("SCULPTURE_SCRIPTS_FROM", 0));
    let mut used = std::collections::BTreeMap::new();
    let commands: u64 = (first..first + count).map(|seed| agree(seed, &mut used)).sum();
    trials::note!("{count} scripts, {commands} commands without a difference: {used:?}");
    if count >= 100 {
        for form in generator::VERBS.iter().chain(&generator::FORMS) {
            assert!(used.contains_key(form), "`{form}` was never accepted");
        }
    }
}

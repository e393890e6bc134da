//! Scripts executed on a document, saved, reopened, undone.

use glam::{UVec3, Vec3};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use sculpture_core::command::text::parse_script;
use sculpture_core::command::{Command, NewSculpture};
use sculpture_core::document::{Document, Limits};
use sculpture_core::sculpture::brick::BRICK_EDGE_VX;
use sculpture_core::sculpture::edit::EditOp;
use sculpture_core::sculpture::history::Contents;
use sculpture_core::sculpture::{Brick, ColourDepth, Grid, Material, Rgb};

use super::strategies;

/// Returns a volume with all kinds of bricks, partly painted.
fn synthetic_volume() -> Contents {
    let dims = UVec3::new(150, 131, 97);
    let mut grid = Grid::new(dims, Vec3::new(1.0, 1.0, 1.25), 1 << 30).unwrap();
    grid.fill_bricks(|b| {
        let mut brick = Brick::EMPTY;
        for i in 0..512u32 {
            let local = UVec3::new(i % 8, i / 8 % 8, i / 64);
            let p = (b * BRICK_EDGE_VX + local).as_vec3() / 9.0;
            let gyroid = p.x.sin() * p.y.cos() + p.y.sin() * p.z.cos() + p.z.sin() * p.x.cos();
            brick.set(local.x, local.y, local.z, gyroid < 0.6);
        }
        brick
    });
    let mut material = Material::for_grid(&grid, ColourDepth::Bits16, Rgb::new(200, 190, 170));
    for brick in (0..grid.brick_count()).step_by(7) {
        let shade = (brick % 251) as u8;
        material.paint_each(grid.brick_coords(brick), grid.brick_at(brick), |i| {
            Rgb::new(shade, i as u8, 255 - shade)
        });
    }
    Contents::new(grid, material)
}

/// Returns everything that undo must restore, as bytes.
fn bytes(contents: &Contents) -> (Vec<u8>, Vec<Option<Vec<u8>>>) {
    let bricks = 0..contents.grid.brick_count();
    let bits = bricks.clone().flat_map(|brick| bytemuck::bytes_of(contents.grid.brick_at(brick)));
    let bits = bits.copied().collect();
    let pages = bricks
        .map(|brick| {
            let page = contents.material.page(contents.grid.brick_coords(brick))?;
            Some(page.write_to(&mut [0; 1536]).to_vec())
        })
        .collect();
    (bits, pages)
}

#[test]
fn a_script_of_200_solids_saves_reloads_and_undoes_to_identical_bytes() {
    let mut runner = TestRunner::deterministic();
    let op = prop_oneof![
        strategies::colour().prop_map(|colour| EditOp::Add(Some(colour))),
        Just(EditOp::Subtract),
        strategies::colour().prop_map(EditOp::Recolour),
    ];
    let strategy = (op, strategies::primitive(0.0..130.0, 2.0..35.0));
    let mut script = String::new();
    for i in 0..200 {
        let (op, primitive) = strategy.new_tree(&mut runner).unwrap().current();
        if i % 20 == 0 {
            script += &format!("begin \"part {i}\"\n");
        }
        script += &format!("{}\n", Command::Construct { op, primitive, to_vx: None });
        if i % 20 == 13 {
            script += "end\n";
        }
    }

    let original = synthetic_volume();
    let mut document = Document::from_contents(original.clone(), Limits::default());
    let mut steps = 0;
    for (_, command) in parse_script(&script).unwrap() {
        let applied = document.apply(&command).unwrap();
        let alone = !document.stroke_open() && applied.stats.voxels_changed() > 0;
        steps += u32::from(alone || command == Command::End);
    }
    assert_ne!(document.contents(), &original);
    assert_eq!(document.history().undo_count() as u32, steps);
    assert!(steps >= 60, "{steps} steps are not much of a test");

    // Saving and reopening is an ordinary step.
    let saved = document.contents().clone();
    document.replace(saved.clone(), "open").unwrap();
    let done = document.apply(&Command::Undo { steps: None }).unwrap();
    assert_eq!(done.steps, steps + 1);
    assert_eq!(bytes(document.contents()), bytes(&original));
    assert_eq!(document.contents(), &original);

    document.apply(&Command::Redo { steps: None }).unwrap();
    assert_eq!(bytes(document.contents()), bytes(&saved));
    assert_eq!(document.contents(), &saved);
}

#[test]
fn scripts_have_the_same_result_as_their_commands() {
    let script = "new dims=20,20,20 colour=24 fill=empty\n\
                  add cuboid at=10,10,10 half=5 colour=#ff0000\n\
                  subtract ellipsoid at=10,10,10 half=3\n\
                  undo\n";
    let new = NewSculpture {
        dims: UVec3::ONE,
        voxel_size: Vec3::ONE,
        colour_depth: ColourDepth::None,
        base: Rgb::default(),
        solid: true,
        room_vx: 0,
        grows: false,
    };
    let mut document = Document::new(&new, Limits::default()).unwrap();
    for (line, command) in parse_script(script).unwrap() {
        document.apply(&command).unwrap_or_else(|error| panic!("line {line}: {error}"));
    }
    assert_eq!(document.grid().opaque_count(), 1000);
    assert_eq!(document.history().undo_labels().collect::<Vec<_>>(), ["new", "add cuboid"]);
    assert_eq!(document.history().redo_labels().collect::<Vec<_>>(), ["subtract ellipsoid"]);
}

//! The tasks of the evaluation of 2005 as scripts: what a person does in the window is replayed, and the result is
//! checked.

use glam::{IVec3, UVec3};
use virtual_sculpture::command::Command;
use virtual_sculpture::command::text::parse_script;
use virtual_sculpture::config::Config;
use virtual_sculpture::headless::DemoScene;
use virtual_sculpture::sculpture::Rgb;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::session::Session;

fn commands(scene: DemoScene) -> Vec<Command> {
    parse_script(scene.script()).unwrap().into_iter().map(|(_, command)| command).collect()
}

fn run(session: &mut Session, command: &Command) {
    if let Err(error) = session.execute(command, &()) {
        panic!("{command}: {error}");
    }
}

fn voxels(dims: UVec3) -> impl Iterator<Item = [i32; 3]> {
    let d = dims.as_ivec3();
    (0..d.z).flat_map(move |z| (0..d.y).flat_map(move |y| (0..d.x).map(move |x| [x, y, z])))
}

/// The verbs and brushes that a script uses.
fn used(commands: &[Command]) -> Vec<String> {
    let mut used: Vec<String> = commands
        .iter()
        .map(|command| match command {
            Command::Brush(used) => used.brush().spec().name.to_string(),
            other => other.verb().to_string(),
        })
        .collect();
    used.sort();
    used.dedup();
    used
}

#[test]
fn the_learning_task_makes_a_rock_and_leaves_the_ground_unhurt() {
    let commands = commands(DemoScene::LearningTask);
    let used = used(&commands);
    for tool in ["mark", "select", "limit", "devourer", "growth", "erosion", "paintbrush", "dye"] {
        assert!(used.iter().any(|u| u == tool), "the task needs {tool}: {used:?}");
    }
    let config = Config::default();
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let (mut cleared, mut cuboid) = (None, 0);
    for command in &commands {
        if *command == Command::Limit(false) {
            // While the limit was on, the ground kept every voxel and every colour.
            let (before, now): (&Contents, _) =
                (cleared.as_ref().unwrap(), session.document().contents());
            for [x, y, z] in voxels(before.grid.dims()).filter(|v| v[1] < 64) {
                let v = [x, y, z];
                assert_eq!(before.colour(v.into()), now.colour(v.into()), "{v:?}");
            }
        }
        run(&mut session, command);
        match command {
            Command::Limit(true) => cleared = Some(session.document().contents().clone()),
            Command::Construct { .. } => cuboid = session.document().grid().opaque_count(),
            _ => {}
        }
    }
    let contents = session.document().contents();
    let ground = 128 * 64 * 128;
    let rock = contents.grid.opaque_count() - ground;
    assert!(rock > (cuboid - ground) / 2, "there is still a rock: {rock}");
    assert!(rock < (cuboid - ground) * 5 / 4);
    assert_eq!(contents.colour([3, 62, 3].into()), Some(Rgb::new(0x6f, 0x9a, 0x45)));
    assert_eq!(contents.colour([3, 3, 3].into()), Some(Rgb::new(0x6b, 0x4a, 0x2f)));
    let painted: Vec<Rgb> = voxels(contents.grid.dims())
        .filter(|v| v[1] >= 64)
        .filter_map(|v| contents.colour(v.into()))
        .collect();
    let greenish = painted.iter().filter(|c| c.0[1] > c.0[0] && c.0[1] > c.0[2]).count();
    assert!(greenish > 500, "moss: {greenish}");
    undo_and_redo(&mut session);
}

#[test]
fn house_tree_lake_and_hill_are_where_they_should_be() {
    let commands = commands(DemoScene::Landscape);
    let used = used(&commands);
    for tool in [
        "add",
        "subtract",
        "recolour",
        "fill",
        "mark",
        "limit",
        "copy",
        "paste",
        "array",
        "clay",
        "smooth",
        "growth",
        "erosion",
        "devourer",
        "paintbrush",
    ] {
        assert!(used.iter().any(|u| u == tool), "no {tool}: {used:?}");
    }
    let config = Config::default();
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    commands.iter().for_each(|command| run(&mut session, command));
    let contents = session.document().contents();
    let top = |x: i32, z: i32| (0..128).rev().find(|y| contents.grid.get(IVec3::new(x, *y, z)));
    let blue = |c: Rgb| c.0[2] > c.0[0] + 30;
    // The lake lies below the meadow and is of water.
    let lake = top(132, 142).unwrap();
    assert!(
        lake < top(20, 180).unwrap() && blue(contents.colour([132, lake, 142].into()).unwrap())
    );
    // The hill is the highest thing.
    let hill = (20..90).flat_map(|x| (20..80).map(move |z| (x, z))).filter_map(|(x, z)| top(x, z));
    assert!(hill.max().unwrap() > 70);
    // The house is hollow, with walls, a door and a roof above.
    assert_eq!(contents.colour([144, 38, 52].into()), None);
    assert_eq!(contents.colour([121, 36, 60].into()), Some(Rgb::new(0xe9, 0xdc, 0xc3)));
    assert_eq!(contents.colour([142, 34, 69].into()), Some(Rgb::new(0x6b, 0x44, 0x28)));
    assert!((55..80).contains(&top(144, 52).unwrap()));
    // Two trees with trunks: the second is the mirrored copy of the first.
    let trunk = contents.colour([40, 40, 140].into()).unwrap();
    assert_eq!(contents.colour([168 + 71 - 40, 40, 140 - 112 + 44].into()), Some(trunk));
    undo_and_redo(&mut session);
}

/// All of it can be undone and redone, to the byte.
fn undo_and_redo(session: &mut Session) {
    let end = session.document().contents().clone();
    // The first step is the new sculpture.
    let steps = session.document().history().undo_count() as u32 - 1;
    run(session, &Command::Undo { steps: Some(steps) });
    let start = session.document().contents();
    let all = start.grid.dims().as_u64vec3().element_product();
    assert!([0, all].contains(&start.grid.opaque_count()));
    assert_eq!(start.material.page_count(), 0);
    run(session, &Command::Redo { steps: None });
    assert_eq!(*session.document().contents(), end);
}

//! A house modelled with mouse and keys in the real window, and replayed from the journal.

use std::process::Command;

use glam::IVec3;
use virtual_sculpture::command::text::parse_script;
use virtual_sculpture::config::Config;
use virtual_sculpture::session::Session;

use super::{LEFT, PICTURE, display, screenshot, start};

// Swatches of the palette, in a window of 1280x800 with a solid selected.
const STONE: [i16; 2] = [1085, 349];
const DARK: [i16; 2] = [1145, 349];
const RED: [i16; 2] = [1055, 377];
const GREEN: [i16; 2] = [1145, 377];

#[test]
fn a_house_is_built_with_mouse_and_keys() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("house.sculpt");
    let program = start(&display, &["--record", journal.to_str().unwrap()]);
    let keys = |names: &[&str]| names.iter().for_each(|name| program.key(&[name]));
    let press = |name: &str, times: usize| (0..times).for_each(|_| program.key(&[name]));

    // An empty grid from the front; a cuboid that adds and does not follow the pointer.
    program.key(&["Control_L", "Delete"]);
    program.key(&["6"]);
    keys(&["c", "t", "f"]);
    program.key(&["Shift_L", "Home"]);
    // The ground: low and wide, green.
    program.click(GREEN);
    press("bracketright", 12);
    press("Down", 30);
    keys(&["space"]);
    // The walls on it, setting one side length of the tool after the other.
    program.key(&["Shift_L", "Home"]);
    press("bracketright", 7);
    press("Up", 16);
    program.click(STONE);
    keys(&["space"]);
    screenshot(&program, "house-1-walls");
    // The roof.
    keys(&["p"]);
    press("bracketright", 2);
    press("Up", 34);
    program.click(RED);
    keys(&["space"]);
    // The door: a small cuboid that cuts, low on the front.
    keys(&["c", "r"]);
    program.key(&["Shift_L", "Home"]);
    press("Next", 15);
    press("Up", 6);
    for _ in 0..6 {
        program.key(&["Shift_L", "Up"]);
    }
    keys(&["space"]);
    let built = screenshot(&program, "house-2-door").part(PICTURE);
    // Windows with the mouse, where the pointer is over the wall; the centre of the picture is the
    // centre of the grid.
    keys(&["f"]);
    press("bracketleft", 4);
    for x in [527, 623] {
        program.drag(LEFT, &[[x, 310]]);
    }
    // Dark tiles on the roof with the brush.
    program.click(DARK);
    keys(&["b"]);
    press("bracketleft", 6);
    program.drag(LEFT, &[[520, 250], [560, 250], [600, 250], [640, 250]]);
    program.key(&["5"]);
    keys(&["e"]);
    let finished = screenshot(&program, "house-3-finished").part(PICTURE);
    assert!(built.differing(&finished) > 5000);

    program.key(&["Control_L", "q"]);
    program.settle();
    program.leave_without_saving();

    // The journal gives the same house without a window.
    let mut config = Config::default();
    config.new.dims = [96; 3];
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    for (line, command) in parse_script(&std::fs::read_to_string(&journal).unwrap()).unwrap() {
        session.execute(&command, &()).unwrap_or_else(|error| panic!("line {line}: {error}"));
    }
    let document = session.document();
    let labels: Vec<&str> = document.history().undo_labels().collect();
    assert_eq!(
        labels,
        [
            // The initial sculpture of the window.
            "new",
            "clear",
            "add cuboid",
            "add cuboid",
            "add pyramid",
            "subtract cuboid",
            "subtract cuboid",
            "subtract cuboid",
            "paintbrush"
        ]
    );
    // The box has grown with the tools.
    assert!(document.grid().dims().max_element() > 96);
    let (grid, origin) = (document.grid(), document.origin());
    let exists = |x, y, z| grid.get(IVec3::new(x, y, z) - origin);
    let top = |x: i32, z: i32| (-96..192).rev().find(|y| exists(x, *y, z));
    let (ridge, eaves, ground) = (top(48, 48).unwrap(), top(30, 48).unwrap(), top(20, 75));
    assert!(ridge > eaves + 10, "the roof rises: {ridge} {eaves}");
    assert!(ground.unwrap() < 50, "the ground is low");
    assert!(document.material().page_count() > 0);

    // The same with the command line.
    let settings = folder.path().join("small.toml");
    std::fs::write(&settings, "[new]\ndims = [96, 96, 96]\n").unwrap();
    let status = Command::new(env!("CARGO_BIN_EXE_virtual-sculpture"))
        .current_dir(folder.path())
        .args(["run", "house.sculpt", "--out", "house.pvm", "--config", "small.toml"])
        .status()
        .unwrap();
    assert!(status.success());
    let saved = folder.path().join("house.pvm");
    let saved = Session::open(&saved, &Default::default(), config.limits(), &()).unwrap();
    assert_eq!(saved.document().grid(), session.document().grid());
}

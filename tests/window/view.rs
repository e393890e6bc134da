//! Aids to seeing in the window: orthographic view, axis gizmo, floor grid, reference pictures, hidden panels.

use x11rb::protocol::xproto::{AtomEnum, ConnectionExt as _};

use super::display::Picture;
use super::program::{Program, SETTINGS};
use super::{display, ready, screenshot, tool_home};

/// The picture of the sculpture without the lower part, in which messages are shown.
const UPPER: [u32; 4] = [120, 50, 900, 520];
/// Around the axis gizmo.
const GIZMO: [u32; 4] = [900, 50, 120, 120];
/// The top of the window, where the menu is.
const TOP: [u32; 4] = [0, 0, 1280, 30];

fn blue(picture: &Picture) -> usize {
    picture.pixels().iter().filter(|[r, _, b]| *b > r.saturating_add(60)).count()
}

#[test]
fn the_view_has_parallel_rays_a_gizmo_a_floor_and_reference_pictures() {
    let display = display();
    // A blue picture behind the front, as a run before has left it.
    let folder = tempfile::tempdir().unwrap().keep();
    let plan = folder.join("plan.png");
    image::RgbImage::from_pixel(300, 200, image::Rgb([20, 60, 250])).save(&plan).unwrap();
    let state = folder.join(".local/state/virtual-sculpture");
    std::fs::create_dir_all(&state).unwrap();
    let text = format!(
        "[[references]]\npath = {:?}\nside = \"front\"\nlayer = \"behind\"\nshown = true\n\
         locked = false\nopacity = 0.6\nheight_vx = 130.0\noffset_vx = [0.0, 10.0]\n",
        plan.display().to_string(),
    );
    std::fs::write(state.join("state.toml"), text).unwrap();
    let program = Program::start_in(&display, folder, &[], SETTINGS);
    program.leave_picture();
    program.settle();
    tool_home(&program);
    let start = screenshot(&program, "view-10-start");
    assert!(blue(&start.part(UPPER)) > 10_000, "the remembered picture is shown");

    program.key(&["o"]);
    let parallel = screenshot(&program, "view-11-orthographic");
    assert!(start.part(UPPER).differing(&parallel.part(UPPER)) > 10_000);
    program.key(&["Shift_L", "g"]);
    let floor = screenshot(&program, "view-12-floor");
    let lines = parallel.part(UPPER).differing(&floor.part(UPPER));
    assert!((2000..100_000).contains(&lines), "{lines}");
    program.key(&["Alt_L", "o"]);
    let without = screenshot(&program, "view-13-no-gizmo");
    let gizmo = floor.part(GIZMO).differing(&without.part(GIZMO));
    assert!((500..8000).contains(&gizmo), "{gizmo}");
    assert_eq!(floor.part(UPPER).differing(&without.part(UPPER)), gizmo, "nothing else changes");

    program.key(&["F10"]);
    let hidden = screenshot(&program, "view-14-hidden");
    assert!(without.part(TOP).differing(&hidden.part(TOP)) > 30_000, "no bar at the top");
    program.key(&["F10"]);
    let back = screenshot(&program, "view-15-back");
    assert_eq!(without.part(UPPER).differing(&back.part(UPPER)), 0);

    program.key(&["7"]);
    program.settle();
    screenshot(&program, "view-16-front");
    program.key(&["Control_L", "Alt_L", "r"]);
    let window = screenshot(&program, "view-17-references");
    assert!(back.differing(&window) > 20_000, "their window is shown");
    program.key(&["Escape"]);
    program.close();
    program.expect_clean_exit();
}

/// The session of a server that has ended may have left its variable.
#[test]
fn a_dead_wayland_server_is_left_for_the_x_server_which_knows_the_program() {
    let display = display();
    let folder = tempfile::tempdir().unwrap().keep();
    let program = ready(Program::start_with_states(&display, folder, |command| {
        command.env("WAYLAND_DISPLAY", "wayland-that-has-gone");
    }));
    let children = display.x.query_tree(display.root).unwrap().reply().unwrap().children;
    let class = |window: u32| {
        let (property, string) = (AtomEnum::WM_CLASS, AtomEnum::STRING);
        let reply = display.x.get_property(false, window, property, string, 0, 64);
        reply.unwrap().reply().unwrap().value
    };
    assert!(children.into_iter().any(|w| class(w) == b"virtual-sculpture\0virtual-sculpture\0"));
    assert_eq!(program.count("using DISPLAY instead"), 1, "{}", program.output());
    program.close();
    assert!(program.wait().0.success());
}

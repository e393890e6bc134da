//! Clay taken along by the pointer in the real window: live, as one step, mirrored, let go by Escape; and the recording
//! gives the same without a window. Brushes that are chosen in the panel and drawn over the surface.

use glam::IVec3;
use virtual_sculpture::command::Command;
use virtual_sculpture::command::text::parse_script;
use virtual_sculpture::config::Config;
use virtual_sculpture::session::Session;

use super::program::{BUTTON, KEY, MOTION};
use super::{LEFT, PICTURE, display, screenshot, start, tool_home};

/// On the front face, just below its upper edge in the middle.
const TOP: [i16; 2] = [575, 172];
// Brushes in the toolbox.
const INFLATE: [i16; 2] = [71, 630];
const FILL: [i16; 2] = [71, 663];
/// The picture without the lower part, in which messages are shown.
const UPPER: [u32; 4] = [120, 50, 900, 520];
const CONTROL: u32 = 0xffe3;

#[test]
fn grabbed_clay_goes_along_with_the_pointer_as_one_step() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("clay.sculpt");
    let program = start(&display, &["--record", recording.to_str().unwrap()]);
    program.key(&["7"]);
    program.key(&["h"]);
    tool_home(&program);
    let before = screenshot(&program, "clay-1-before").part(PICTURE);
    let device = |kind: u8, detail: u8, [x, y]: [i16; 2]| {
        program.display().device(kind, detail, [TOP[0] + x, TOP[1] + y]);
        program.settle();
    };

    // The upper edge of the block follows the pointer before the button is released.
    device(MOTION, 0, [0, 0]);
    screenshot(&program, "clay-2-over-it");
    device(BUTTON, LEFT, [0, 0]);
    device(MOTION, 0, [0, 20]);
    let little = screenshot(&program, "clay-3-a-little").part(PICTURE);
    device(MOTION, 0, [20, 60]);
    let far = screenshot(&program, "clay-4-far").part(PICTURE);
    assert!(little.differing(&far) > 1000, "{}", little.differing(&far));
    // Back where it was taken hold of, nothing is left of the way.
    device(MOTION, 0, [0, 0]);
    device(BUTTON + 1, LEFT, [0, 0]);
    program.leave_picture();
    tool_home(&program);
    assert_eq!(before.differing(&screenshot(&program, "clay-5-back").part(PICTURE)), 0);

    // Once more in several steps: one undo takes it back, redo gives it again.
    let path = [[0, 0], [0, 15], [5, 30], [10, 45], [20, 60]];
    program.drag(LEFT, &path.map(|[x, y]| [TOP[0] + x, TOP[1] + y]));
    tool_home(&program);
    let pulled = screenshot(&program, "clay-6-pulled").part(PICTURE);
    assert!(before.differing(&pulled) > 1500, "{}", before.differing(&pulled));
    program.key(&["Control_L", "z"]);
    assert_eq!(before.differing(&screenshot(&program, "clay-7-undone").part(PICTURE)), 0);
    program.key(&["Control_L", "y"]);
    assert_eq!(pulled.differing(&screenshot(&program, "clay-8-redone").part(PICTURE)), 0);
    program.key(&["Control_L", "z"]);

    // Escape lets go, and what the button still does then changes nothing.
    device(MOTION, 0, [0, 0]);
    device(BUTTON, LEFT, [0, 0]);
    device(MOTION, 0, [0, 40]);
    program.key(&["Escape"]);
    device(MOTION, 0, [0, 50]);
    device(BUTTON + 1, LEFT, [0, 50]);
    program.leave_picture();
    tool_home(&program);
    assert_eq!(before.differing(&screenshot(&program, "clay-9-cancelled").part(PICTURE)), 0);

    // Mirrored in x.
    program.key(&["1"]);
    program.drag(LEFT, &[[TOP[0] - 120, TOP[1]], [TOP[0] - 100, TOP[1] + 30]]);
    screenshot(&program, "clay-10-mirrored");
    program.key(&["Control_L", "q"]);
    program.settle();
    program.leave_without_saving();

    let mut config = Config::default();
    config.new.dims = [96; 3];
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let script = std::fs::read_to_string(&recording).unwrap();
    for (line, command) in parse_script(&script).unwrap() {
        session.execute(&command, &()).unwrap_or_else(|error| panic!("line {line}: {error}"));
    }
    let labels: Vec<&str> = session.document().history().undo_labels().collect();
    assert_eq!(labels, ["new", "grab"], "{script}");
    let grid = session.document().grid();
    let lost = 96u64.pow(3) - grid.opaque_count();
    assert!((300..20_000).contains(&lost), "{lost}");
    for (x, y) in (0..48).flat_map(|x| (60..96).map(move |y| (x, y))) {
        let mirrored = IVec3::new(95 - x, y, 95);
        assert_eq!(grid.get(IVec3::new(x, y, 95)), grid.get(mirrored), "{mirrored}");
    }
}

#[test]
fn brushes_that_deform_are_chosen_in_the_toolbox_and_drawn_over_the_surface() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("brushes.sculpt");
    let program = start(&display, &["--record", recording.to_str().unwrap()]);
    program.key(&["7"]);
    program.key(&["h"]);
    // A furrow along the front, with the modifier that inverts.
    program.click(INFLATE);
    tool_home(&program);
    let before = screenshot(&program, "brush-1-before").part(UPPER);
    program.display().device(KEY, program.display().keycode(CONTROL), [0, 0]);
    program.drag(LEFT, &[[440, 300], [500, 330], [560, 300], [640, 340]]);
    program.display().device(KEY + 1, program.display().keycode(CONTROL), [0, 0]);
    tool_home(&program);
    let furrow = screenshot(&program, "brush-3-furrow").part(UPPER);
    assert!(before.differing(&furrow) > 1500, "{}", before.differing(&furrow));

    // A part of it is filled up again, to the plane of the front.
    program.click(FILL);
    screenshot(&program, "brush-4-fill");
    program.drag(LEFT, &[[740, 340], [680, 330], [600, 310]]);
    tool_home(&program);
    let filled = screenshot(&program, "brush-5-filled").part(UPPER);
    assert!(filled.differing(&furrow) > 500, "{}", filled.differing(&furrow));
    assert!(filled.differing(&before) < furrow.differing(&before));
    program.key(&["Control_L", "z"]);
    assert_eq!(furrow.differing(&screenshot(&program, "brush-6-undone").part(UPPER)), 0);
    program.key(&["Control_L", "z"]);
    assert_eq!(before.differing(&screenshot(&program, "brush-7-all-undone").part(UPPER)), 0);
    program.key(&["Control_L", "y"]);
    program.key(&["Control_L", "q"]);
    program.settle();
    program.leave_without_saving();

    let mut config = Config::default();
    config.new.dims = [96; 3];
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let script = std::fs::read_to_string(&recording).unwrap();
    for (line, command) in parse_script(&script).unwrap() {
        session.execute(&command, &()).unwrap_or_else(|error| panic!("line {line}: {error}"));
    }
    let labels: Vec<&str> = session.document().history().undo_labels().collect();
    assert_eq!(labels, ["new", "inflate"], "{script}");
    // However often the brush was used on its way, it went nowhere deeper than once: half of half its radius, 40 pixels or
    // 8 voxels there.
    let grid = session.document().grid();
    let deepest = (0..96 * 96)
        .map(|i| (0..96).take_while(|z| !grid.get(IVec3::new(i % 96, i / 96, 95 - z))).count())
        .max();
    assert_eq!(deepest, Some(2), "{script}");
}

#[test]
fn clay_is_drawn_creased_pinched_twisted_and_smeared() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("clay.sculpt");
    let program = start(&display, &["--record", recording.to_str().unwrap()]);
    program.key(&["7"]);
    let shift = |key: &str| program.key(&["Shift_L", key]);
    let stroke = |key: &str, path: &[[i16; 2]]| {
        // The face of the block is that of the grid, so that nothing can be raised out of it.
        let invert = |up: u8| {
            if key == "f" {
                program.display().device(KEY + up, program.display().keycode(CONTROL), [0, 0]);
            }
        };
        shift(key);
        tool_home(&program);
        let before = screenshot(&program, &format!("brushes-{key}-before")).part(UPPER);
        invert(0);
        program.drag(LEFT, path);
        invert(1);
        tool_home(&program);
        let after = screenshot(&program, &format!("brushes-{key}-done")).part(UPPER);
        assert!(before.differing(&after) > 300, "{key}: {}", before.differing(&after));
        program.key(&["Control_L", "z"]);
        let undone = screenshot(&program, &format!("brushes-{key}-undone")).part(UPPER);
        assert_eq!(before.differing(&undone), 0, "{key}");
        program.key(&["Control_L", "y"]);
    };
    // A trough across the front, a furrow below it; the trough's edge is pinched, twisted and smeared.
    stroke("f", &[[440, 300], [540, 300], [640, 300], [740, 300]]);
    stroke("v", &[[440, 420], [540, 420], [640, 420], [740, 420]]);
    stroke("n", &[[460, 320], [500, 320], [540, 320]]);
    stroke("w", &[[590, 320], [640, 320], [690, 320]]);
    stroke("m", &[[700, 330], [705, 310], [710, 280]]);
    program.key(&["Control_L", "q"]);
    program.settle();
    program.leave_without_saving();

    let mut config = Config::default();
    config.new.dims = [96; 3];
    let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    let script = std::fs::read_to_string(&recording).unwrap();
    let mut counts = Vec::new();
    for (line, command) in parse_script(&script).unwrap() {
        session.execute(&command, &()).unwrap_or_else(|error| panic!("line {line}: {error}"));
        if command == Command::End {
            counts.push(session.document().grid().opaque_count());
        }
    }
    let labels: Vec<&str> = session.document().history().undo_labels().collect();
    assert_eq!(labels, ["new", "draw", "crease", "pinch", "twist", "smear"], "{script}");
    let block = 96u64.pow(3);
    assert!(counts.windows(2).all(|pair| pair[0].abs_diff(pair[1]) * 50 < block), "{counts:?}");
}

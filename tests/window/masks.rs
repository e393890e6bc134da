//! Masks and symmetry in the real window: what is masked is seen, tools leave it alone, and planes and axes are drawn.

use super::{LEFT, PICTURE, display, screenshot, start};

#[test]
fn a_mask_is_seen_and_kept_and_symmetry_is_drawn() {
    let display = display();
    let program = start(&display, &[]);
    program.leave_picture();
    let plain = screenshot(&program, "mask-0-plain").part(PICTURE);
    program.key(&["Shift_L", "q"]);
    program.drag(LEFT, &[[440, 420], [500, 440], [560, 470]]);
    program.leave_picture();
    let masked = screenshot(&program, "mask-1-masked").part(PICTURE);
    assert!(plain.differing(&masked) > 500, "{}", plain.differing(&masked));
    // Hidden, it looks as before.
    program.key(&["Control_L", "Alt_L", "j"]);
    program.leave_picture();
    let hidden = screenshot(&program, "mask-2-hidden").part(PICTURE);
    assert!(plain.differing(&hidden) < masked.differing(&hidden) / 4);
    program.key(&["Control_L", "Alt_L", "j"]);
    // A cut through the middle of it, and all around: what is masked stands.
    program.key(&["e"]);
    program.key(&["r"]);
    program.drag(LEFT, &[[430, 470], [520, 440], [600, 430]]);
    program.leave_picture();
    let cut = screenshot(&program, "mask-3-cut").part(PICTURE);
    assert!(masked.differing(&cut) > 300, "{}", masked.differing(&cut));
    program.key(&["Alt_L", "j"]);
    screenshot(&program, "mask-4-window");
    program.key(&["Escape"]);
    program.key(&["Control_L", "Shift_L", "j"]);
    program.leave_picture();
    let cleared = screenshot(&program, "mask-5-cleared").part(PICTURE);
    assert!(cut.differing(&cleared) > 300, "{}", cut.differing(&cleared));
    program.key(&["4"]);
    program.leave_picture();
    let plane = screenshot(&program, "mask-6-plane").part(PICTURE);
    assert!(cleared.differing(&plane) > 100, "{}", cleared.differing(&plane));
    program.key(&["4"]);
    program.key(&["Alt_L", "4"]);
    program.drag(LEFT, &[[520, 300], [522, 302]]);
    program.leave_picture();
    let radial = screenshot(&program, "mask-7-radial").part(PICTURE);
    assert!(cleared.differing(&radial) > 300, "{}", cleared.differing(&radial));
    // All of it masked and seen to be, saved pictures are as without.
    program.key(&["Control_L", "j"]);
    program.leave_picture();
    let all = screenshot(&program, "mask-8-all").part(PICTURE);
    assert!(radial.differing(&all) > 1000, "{}", radial.differing(&all));
    program.key(&["F12"]);
    program.settle();
    program.key(&["Control_L", "Shift_L", "j"]);
    program.key(&["F12"]);
    program.settle();
    let [masked, bare] = ["sculpture-1.png", "sculpture-2.png"]
        .map(|name| image::open(program.folder().join(name)).unwrap().to_rgb8());
    assert!(masked == bare, "the mask is seen in a saved picture");
    program.key(&["Control_L", "q"]);
    program.settle();
    program.leave_without_saving();
}

//! Tools that draw solids, in the real window: what is shown while the button is pressed, what comes of it, and that the
//! recording gives the same without a window.

use virtual_sculpture::command::text::parse_script;
use virtual_sculpture::config::Config;
use virtual_sculpture::session::Session;

use super::program::{BUTTON, MOTION};
use super::{LEFT, PICTURE, display, screenshot, start};

#[test]
fn drawn_solids_are_shown_while_they_are_drawn_and_recorded_as_commands() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("drawn.sculpt");
    let program = start(&display, &["--record", recording.to_str().unwrap()]);
    let device = |kind: u8, detail: u8, at: [i16; 2]| {
        program.display().device(kind, detail, at);
        program.settle();
    };
    // Draws, with a picture before the button is released, and gives that before it was pressed.
    let base = |name: &str, path: &[[i16; 2]]| {
        let before = screenshot(&program, &format!("draw-{name}-0")).part(PICTURE);
        device(MOTION, 0, path[0]);
        screenshot(&program, &format!("draw-{name}-1-before"));
        device(BUTTON, LEFT, path[0]);
        path.iter().for_each(|at| device(MOTION, 0, *at));
        let during = screenshot(&program, &format!("draw-{name}-2-during")).part(PICTURE);
        device(BUTTON + 1, LEFT, path[path.len() - 1]);
        assert!(before.differing(&during) > 100, "{name} shows nothing while it is drawn");
        before
    };
    // The same, with a picture after it.
    let draw = |name: &str, path: &[[i16; 2]]| {
        let before = base(name, path);
        program.leave_picture();
        let after = screenshot(&program, &format!("draw-{name}-3-after")).part(PICTURE);
        assert!(before.differing(&after) > 300, "{name} changes nothing");
    };
    let click = |at: [i16; 2]| {
        device(MOTION, 0, at);
        device(BUTTON, LEFT, at);
        device(BUTTON + 1, LEFT, at);
    };
    // In an empty grid: a plinth on its floor, a vase on it with a handle, an inscription.
    program.key(&["Control_L", "Delete"]);
    program.key(&["t"]);
    program.key(&["Alt_L", "b"]);
    base("box", &[[440, 540], [560, 600], [640, 590]]);
    // The pointer raises it, and a click ends it.
    device(MOTION, 0, [640, 540]);
    let raised = screenshot(&program, "draw-box-4-raised").part(PICTURE);
    click([640, 540]);
    program.leave_picture();
    let ended = screenshot(&program, "draw-box-5-ended").part(PICTURE);
    assert!(raised.differing(&ended) > 300, "a click makes the box");
    program.key(&["Alt_L", "w"]);
    let profile = [
        [560, 500],
        [610, 500],
        [625, 460],
        [600, 400],
        [620, 350],
        [612, 345],
        [592, 400],
        [560, 440],
    ];
    draw("lathe", &profile);
    program.key(&["Alt_L", "u"]);
    draw("curve", &[[612, 370], [650, 360], [675, 400], [660, 450], [622, 470]]);
    program.key(&["Alt_L", "i"]);
    draw("line", &[[470, 530], [420, 380]]);
    program.key(&["Alt_L", "y"]);
    draw("text", &[[500, 560], [530, 575]]);
    program.key(&["1"]);
    program.key(&["Alt_L", "u"]);
    draw("mirrored", &[[400, 560], [420, 520], [440, 560], [460, 530]]);
    // Point by point, each seen with its image.
    let before = screenshot(&program, "draw-points-0").part(PICTURE);
    [[420, 460], [470, 420], [500, 470]].iter().for_each(|at| click(*at));
    device(MOTION, 0, [530, 400]);
    let during = screenshot(&program, "draw-points-1-during").part(PICTURE);
    assert!(before.differing(&during) > 300, "a curve by points is shown");
    program.key(&["Return"]);
    program.leave_picture();
    let after = screenshot(&program, "draw-points-2-after").part(PICTURE);
    assert!(before.differing(&after) > 300, "Enter makes it");
    program.key(&["1"]);
    program.key(&["r"]);
    program.key(&["Alt_L", "p"]);
    draw("plane", &[[720, 400], [560, 380], [400, 370]]);
    program.key(&["Alt_L", "l"]);
    draw("lasso", &[[540, 420], [570, 410], [590, 450], [560, 470], [545, 450]]);
    program.key(&["Alt_L", "q"]);
    draw("rectangle", &[[440, 480], [500, 530]]);
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
    let drawn = [
        "new",
        "clear",
        "add cuboid",
        "add lathe",
        "add tube",
        "add tube",
        "text",
        "add tube",
        "add tube",
        "subtract half-space",
        "subtract extrusion",
        "subtract extrusion",
    ];
    assert_eq!(labels, drawn, "{script}");
}

#[test]
fn letters_are_typed_in_the_panel_and_cut_into_a_face() {
    let display = display();
    let program = start(&display, &[]);
    program.key(&["Alt_L", "y"]);
    // The field, whose letters are no keys of tools.
    program.click([1150, 129]);
    program.key(&["Control_L", "a"]);
    ["m", "u", "g"].iter().for_each(|letter| program.key(&[letter]));
    let before = screenshot(&program, "letters-1-typed").part(PICTURE);
    program.drag(LEFT, &[[470, 380], [460, 400]]);
    program.leave_picture();
    let after = screenshot(&program, "letters-2-cut").part(PICTURE);
    assert!(before.differing(&after) > 500, "{}", before.differing(&after));
    program.key(&["Control_L", "z"]);
    program.leave_picture();
    let undone = screenshot(&program, "letters-3-undone").part(PICTURE);
    assert_eq!(before.differing(&undone), 0, "all letters are one step");
}

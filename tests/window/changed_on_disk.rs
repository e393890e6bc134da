//! A file that another program has changed while it is open: the window asks before it is overwritten.

use virtual_sculpture::config::Config;
use virtual_sculpture::sculpture::Limits;
use virtual_sculpture::session::Session;

use super::program::{Program, SETTINGS};
use super::{LEFT, display, ready, screenshot};

#[test]
fn a_changed_file_is_overwritten_only_after_the_question() {
    let display = display();
    let folder = tempfile::tempdir().unwrap().keep();
    let path = folder.join("owl.vsc");
    let write = |edge: u32| {
        let mut config = Config::default();
        config.new.dims = [edge; 3];
        let mut session = Session::new(&config.new_sculpture(), config.limits()).unwrap();
        // As a program that heeds no locks.
        let made = folder.join("made.vsc");
        session.execute(&format!("save {made:?}").parse().unwrap(), &()).unwrap();
        std::fs::rename(&made, &path).unwrap();
        std::fs::read(&path).unwrap()
    };
    write(64);
    let name = path.to_str().unwrap();
    let program = ready(Program::start_in(&display, folder.clone(), &[name], SETTINGS));
    program.drag(LEFT, &[[560, 400], [600, 400], [640, 400]]);
    program.settle();
    let foreign = write(32);

    let before = screenshot(&program, "changed-on-disk-0");
    program.key(&["Control_L", "s"]);
    program.until("the question is shown", || {
        program.display().picture().differing(&before) > 100_000
    });
    screenshot(&program, "changed-on-disk-1-asked");
    assert_eq!(std::fs::read(&path).unwrap(), foreign);
    program.key(&["Escape"]);
    screenshot(&program, "changed-on-disk-2-cancelled");
    assert_eq!(std::fs::read(&path).unwrap(), foreign);

    program.key(&["Control_L", "s"]);
    screenshot(&program, "changed-on-disk-3-asked-again");
    // Save as, Overwrite, Reload, Cancel: two Tabs lead to the second button.
    for key in ["Tab", "Tab", "space"] {
        program.key(&[key]);
    }
    program.until("it is overwritten", || std::fs::read(&path).unwrap() != foreign);
    screenshot(&program, "changed-on-disk-4-overwritten");
    // Nothing is unsaved.
    program.close();
    let (status, output) = program.wait();
    assert!(status.success(), "{output}");
    let back = Session::open(&path, &Default::default(), Limits::default(), &()).unwrap();
    assert_eq!(back.document().grid().dims(), glam::UVec3::splat(64));
}

//! A sculpture that another program has open: the window asks how to go on, and does not overwrite it.

use virtual_sculpture::config::Config;
use virtual_sculpture::session::{FileAccess, Session};

use super::program::{Program, SETTINGS};
use super::{LEFT, display, ready, screenshot};

#[test]
fn a_file_that_is_open_elsewhere_is_not_overwritten() {
    let display = display();
    let folder = tempfile::tempdir().unwrap().keep();
    let path = folder.join("owl.vsc");
    let mut config = Config::default();
    config.new.dims = [64; 3];
    let mut other = Session::new(&config.new_sculpture(), config.limits()).unwrap();
    other.set_file_access(FileAccess::Locked);
    other.execute(&format!("save {path:?}").parse().unwrap(), &()).unwrap();
    let bytes = std::fs::read(&path).unwrap();

    let name = path.to_str().unwrap();
    let program = ready(Program::start_in(&display, folder.clone(), &[name], SETTINGS));
    let asked = screenshot(&program, "in-use-1-asked");
    // Open a copy, Read only: two Tabs lead to the second button.
    for key in ["Tab", "Tab", "space"] {
        program.key(&[key]);
    }
    program.until("the question is answered", || {
        program.display().picture().differing(&asked) > 100_000
    });
    program.drag(LEFT, &[[560, 400], [600, 400], [640, 400]]);
    let before = screenshot(&program, "in-use-2-carved");
    program.key(&["Control_L", "s"]);
    program
        .until("a name is asked for", || program.display().picture().differing(&before) > 100_000);
    screenshot(&program, "in-use-3-name");
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
}

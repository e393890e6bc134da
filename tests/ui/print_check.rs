//! The window of the print check: it checks when it is opened, marks the faults and repairs them.

use egui::{Key, Modifiers};
use virtual_sculpture::print_check::FaultKind;

use super::bench::{Bench, bench, click, click_once, has, key, rest, run, undo_count, voxels};

fn finish(harness: &mut Bench) {
    harness.run_steps(2);
    harness.state_mut().finish_job();
    harness.run_steps(6);
    rest(harness);
}

fn lines(harness: &Bench) -> usize {
    let workspace = harness.state();
    workspace.ui.dialogs.print_check.lines(workspace.session().document()).len()
}

#[test]
fn faults_are_listed_marked_and_repaired() {
    let mut harness = bench();
    for line in [
        "clear",
        "add cuboid at=20,20,20 half=12",
        "subtract cuboid at=20,20,20 half=4",
        "add cuboid at=20,50,20 half=3",
    ] {
        run(&mut harness, line);
    }
    let before = voxels(&harness);
    key(&mut harness, Modifiers::CTRL | Modifiers::ALT, Key::P);
    finish(&mut harness);
    let kinds = [FaultKind::Islands, FaultKind::Cavities, FaultKind::Overhangs];
    for label in ["Floating pieces: 1", "Closed cavities: 1", "Overhangs: 2", "Check again"] {
        assert!(has(&harness, label), "{label}");
    }
    // A box each of 12 edges, and lines through their voxels.
    let marked = lines(&harness);
    assert!(marked > 12 * (kinds.len() + 1) + 100, "{marked}");
    click(&mut harness, "6.0 x 6.0 x 6.0 mm, 216 voxels");
    let marker = harness.state().session().document().selection().marker();
    assert_eq!((marker.min.to_array(), marker.max.to_array()), ([17, 47, 17], [23, 53, 23]));
    assert_eq!(lines(&harness), marked + 12, "the chosen place is framed");

    let steps = undo_count(&harness);
    click_once(&mut harness, "Remove islands");
    finish(&mut harness);
    assert_eq!((voxels(&harness), undo_count(&harness)), (before - 216, steps + 1));
    assert_eq!(lines(&harness), 0, "the marks no longer hold");
    assert!(has(&harness, "The sculpture has changed since: check again."));
    click_once(&mut harness, "Check again");
    finish(&mut harness);
    assert!(!has(&harness, "Floating pieces: 1") && has(&harness, "Closed cavities: 1"));
    click(&mut harness, "Show in the view");
    assert_eq!(lines(&harness), 0);
    key(&mut harness, Modifiers::CTRL | Modifiers::ALT, Key::P);
    rest(&mut harness);
    assert!(!has(&harness, "Check again") && !harness.state().editor.is_busy());
}

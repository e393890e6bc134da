//! However the program ends in its window, `recover` gives back all strokes that had ended.

use super::kills::{expect_back, states_of};
use super::program::{BUTTON, MOTION, Program};
use super::{LEFT, PICTURE, display, ready, screenshot, tool_home};

fn start(display: &super::display::Display) -> (tempfile::TempDir, Program<'_>) {
    let folder = tempfile::tempdir().unwrap();
    let program = Program::start_with_states(display, folder.path().to_path_buf(), |_| {});
    (folder, ready(program))
}

/// A stroke that has ended and is in the journal, and one that goes on.
fn work(program: &Program) {
    program.drag(LEFT, &[[430, 380], [470, 400], [520, 410]]);
    program.until("the stroke is in the journal", || {
        let states = states_of(&program.output());
        states.written >= 3 && states.written == states.done.len()
    });
    let ended = states_of(&program.output()).done;
    assert!(!ended[ended.len() - 1].1, "the stroke has ended");
    let display = program.display();
    display.device(MOTION, 0, [560, 300]);
    program.settle();
    display.device(BUTTON, LEFT, [560, 300]);
    display.device(MOTION, 0, [590, 320]);
    program.until("a stroke goes on", || {
        states_of(&program.output()).done.last().is_some_and(|(_, in_stroke)| *in_stroke)
    });
}

#[test]
fn signals_lose_nothing_that_had_ended() {
    let display = display();
    for signal in crate::signals::heeded() {
        let (folder, program) = start(&display);
        work(&program);
        program.signal(signal);
        let (status, output) = program.wait();
        assert!(!status.success(), "{signal}");
        assert_eq!(expect_back(folder.path(), &output), 0, "{signal}");
        display.device(BUTTON + 1, LEFT, [590, 320]);
    }
}

#[test]
fn a_display_that_is_gone_loses_nothing_that_had_ended() {
    let display = display();
    let (folder, program) = start(&display);
    work(&program);
    display.kill();
    let (status, output) = program.wait();
    assert!(!status.success(), "{output}");
    assert_eq!(expect_back(folder.path(), &output), 0);
}

#[test]
fn a_fault_of_the_program_loses_nothing_and_says_where_it_is() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let program = Program::start_with_states(&display, folder.path().to_path_buf(), |command| {
        command.env("VS_PANIC_AT", "9");
    });
    let program = ready(program);
    display.device(MOTION, 0, [430, 380]);
    program.settle();
    for _ in 0..9 {
        if !program.is_running() {
            break;
        }
        display.device(BUTTON, LEFT, [430, 380]);
        display.device(BUTTON + 1, LEFT, [430, 380]);
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    let (status, output) = program.wait();
    assert_eq!(status.code(), Some(101), "{output}");
    assert!(output.contains("VS_PANIC_AT asked for it"), "{output}");
    let path = folder.path().join(".local/state/virtual-sculpture/journals/1.journal");
    assert!(output.contains(&format!("is in the journal {}", path.display())), "{output}");
    assert_eq!(states_of(&output).written, 9, "the hook has waited for the journal");
    assert_eq!(expect_back(folder.path(), &output), 0);
}

/// A device that is lost again and again ends the program.
#[test]
fn a_device_that_is_lost_for_good_loses_nothing() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let mut faults = None;
    let program = Program::start_with_states(&display, folder.path().to_path_buf(), |command| {
        faults = Some(crate::faults::Faults::new(folder.path(), command));
    });
    let program = ready(program);
    work(&program);
    faults.unwrap().set("acquire -4");
    display.device(MOTION, 0, [600, 330]);
    let (status, output) = program.wait();
    assert!(!status.success(), "{output}");
    assert!(output.contains("1.journal: the next start offers it"), "{output}");
    assert_eq!(expect_back(folder.path(), &output), 0);
}

/// A person works; the program is killed and started again; the work is there again.
#[test]
fn a_killed_session_is_recovered_in_the_next_window() {
    let display = display();
    let folder = tempfile::tempdir().unwrap();
    let program = Program::start_with_states(&display, folder.path().to_path_buf(), |_| {});
    let program = ready(program);
    for path in [
        [[430, 380], [470, 400], [520, 410]],
        [[560, 300], [600, 330], [640, 320]],
        [[420, 470], [470, 490], [530, 480]],
    ] {
        program.drag(LEFT, &path);
    }
    program.key(&["Control_L", "z"]);
    tool_home(&program);
    let worked = screenshot(&program, "recovery-1-work");
    program.until("all is in the journal", || {
        let states = states_of(&program.output());
        states.written > 0 && states.written == states.done.len()
    });
    let steps = states_of(&program.output());
    program.signal("-KILL");
    let (_, output) = program.wait();
    save_screenshot(&display, "recovery-2-killed");
    assert_eq!(states_of(&output).done.len(), steps.done.len());
    drop(program);

    let program = Program::start_with_states(&display, folder.path().to_path_buf(), |_| {});
    let program = ready(program);
    let listed = screenshot(&program, "recovery-3-next-start");
    assert!(listed.part(PICTURE).differing(&worked.part(PICTURE)) > 10_000, "the list is shown");
    // The first button is that of the first session.
    program.key(&["Tab"]);
    program.key(&["space"]);
    program.settle();
    tool_home(&program);
    let recovered = screenshot(&program, "recovery-4-recovered");
    assert_eq!(recovered.part(ABOVE_MESSAGES).differing(&worked.part(ABOVE_MESSAGES)), 0);
    program.key(&["Control_L", "y"]);
    let redone = screenshot(&program, "recovery-5-redone");
    assert!(
        redone.part(ABOVE_MESSAGES).differing(&worked.part(ABOVE_MESSAGES)) > 500,
        "redo is there"
    );
    program.close();
    program.leave_without_saving();
}

/// The picture without its lower edge, where messages are.
const ABOVE_MESSAGES: [u32; 4] = [120, 50, 900, 600];

fn save_screenshot(display: &super::display::Display, name: &str) {
    display.sync();
    display.picture().save(name);
}

//! Failing calls of drivers and window systems: the program goes on, and shows the same picture afterwards.

use super::program::Program;
use super::{PICTURE, display, screenshot, tool_home};

/// The failing call and its result (`VkResult`).
const FAILURES: [(&str, &str); 6] = [
    ("swapchain", "VK_ERROR_NATIVE_WINDOW_IN_USE_KHR -1000000001"),
    ("swapchain", "VK_ERROR_INITIALIZATION_FAILED -3"),
    ("acquire", "VK_ERROR_OUT_OF_DATE_KHR -1000001004"),
    ("acquire", "VK_ERROR_SURFACE_LOST_KHR -1000000000"),
    ("present", "VK_ERROR_OUT_OF_DATE_KHR -1000001004"),
    ("present", "VK_SUBOPTIMAL_KHR 1000001003"),
];

fn code(result: &str) -> &str {
    result.split(' ').next_back().unwrap()
}

#[test]
fn transient_failures_of_a_driver_are_survived() {
    let display = display();
    let (program, faults) = Program::start_failing(&display);
    program.settle();
    program.leave_picture();
    tool_home(&program);
    let before = screenshot(&program, "faults-1-before").part(PICTURE);
    for (i, (call, result)) in FAILURES.into_iter().enumerate() {
        faults.set(&format!("{call} {}", code(result)));
        // A resize needs another swapchain and other pictures.
        program.resize([1000, 700 + i as u32]);
        // It keeps trying: pictures are shown or skipped, or another swapchain is created.
        let steps = || {
            let logged = ["a picture is left out", "swapchain of", "picture shown"];
            logged.into_iter().map(|what| program.count(what)).sum::<usize>()
        };
        let first = steps();
        program.until(result, || steps() > first + 2);
        faults.set("");
        program.resize([1280, 800]);
        let after = screenshot(&program, &format!("faults-2-{i}")).part(PICTURE);
        assert_eq!(before.differing(&after), 0, "{call} {result}");
    }
    program.close();
    program.expect_clean_exit();
}

#[test]
fn a_permanent_failure_of_a_driver_is_an_error() {
    let display = display();
    let (program, faults) = Program::start_failing(&display);
    program.settle();
    faults.set("swapchain -1000000001");
    program.resize([1000, 700]);
    let (status, output) = program.wait();
    assert!(
        !status.success() && output.contains("make the window's swapchain"),
        "{status}: {output}"
    );
    assert!(!output.contains("panicked"), "{output}");
}

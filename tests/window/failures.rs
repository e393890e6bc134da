//! What drivers and window systems refuse: the program goes on, and shows the same picture afterwards.

use super::program::Program;
use super::{PICTURE, display, shot, tool_home};

/// The call that fails, and how (`VkResult`).
const REFUSALS: [(&str, &str); 6] = [
    ("swapchain", "VK_ERROR_NATIVE_WINDOW_IN_USE_KHR -1000000001"),
    ("swapchain", "VK_ERROR_INITIALIZATION_FAILED -3"),
    ("acquire", "VK_ERROR_OUT_OF_DATE_KHR -1000001004"),
    ("acquire", "VK_ERROR_SURFACE_LOST_KHR -1000000000"),
    ("present", "VK_ERROR_OUT_OF_DATE_KHR -1000001004"),
    ("present", "VK_SUBOPTIMAL_KHR 1000001003"),
];

fn code(refusal: &str) -> &str {
    refusal.split(' ').next_back().unwrap()
}

#[test]
fn what_a_driver_refuses_for_a_moment_ends_nothing() {
    let display = display();
    let (program, faults) = Program::start_failing(&display);
    program.settle();
    program.leave_picture();
    tool_home(&program);
    let before = shot(&program, "faults-1-before").part(PICTURE);
    for (i, (call, refusal)) in REFUSALS.into_iter().enumerate() {
        faults.set(&format!("{call} {}", code(refusal)));
        // A resize asks for another swapchain and other pictures.
        program.resize([1000, 700 + i as u32]);
        // It tries on: pictures are shown or left out, or there is another swapchain.
        let steps = || {
            let logged = ["a picture is left out", "swapchain of", "picture shown"];
            logged.into_iter().map(|what| program.count(what)).sum::<usize>()
        };
        let begun = steps();
        program.until(refusal, || steps() > begun + 2);
        faults.set("");
        program.resize([1280, 800]);
        let after = shot(&program, &format!("faults-2-{i}")).part(PICTURE);
        assert_eq!(before.differing(&after), 0, "{call} {refusal}");
    }
    program.close();
    program.expect_clean_exit();
}

#[test]
fn a_driver_that_refuses_for_good_is_an_error() {
    let display = display();
    let (program, faults) = Program::start_failing(&display);
    program.settle();
    faults.set("swapchain -1000000001");
    program.resize([1000, 700]);
    let (status, said) = program.wait();
    assert!(!status.success() && said.contains("make the window's swapchain"), "{status}: {said}");
    assert!(!said.contains("panicked"), "{said}");
}

//! Failures of runtimes and devices: none of them blocks the window, or ends the connection where it can be kept.

use std::time::Duration;

use virtual_sculpture::render::RenderMode;

use super::main_loop::MainLoop;
use super::runtime::{Runtime, alone_in_network, is_client, stop_service};

/// Longest iteration of the main loop: longer than the timeouts within a frame, with a margin for a busy
/// machine.
const LONGEST_ITERATION: Duration = Duration::from_millis(700);
/// How long a slow runtime takes for each call of connecting.
const SLOW: Duration = Duration::from_millis(1500);

#[test]
fn a_runtime_that_hangs_does_not_block_the_window() {
    if is_client() {
        let mut main = MainLoop::new(32);
        main.until_showing();
        for round in 0..4 {
            stop_service(true);
            let longest = [
                main.until("silence", |main, _| !main.headset.is_showing()),
                main.until("half a second", |_, after| after > Duration::from_millis(500)),
            ];
            stop_service(false);
            assert!(
                longest.iter().all(|iteration| *iteration < LONGEST_ITERATION),
                "{longest:?} in round {round}"
            );
            main.until_showing();
        }
        assert_eq!(main.headset.validation_messages(), 0);
    } else if alone_in_network() {
        Runtime::start().run_client();
    }
}

#[test]
fn a_runtime_that_takes_seconds_to_connect_does_not_block_the_window() {
    if is_client() {
        let mut main = MainLoop::new(32);
        // The connection cannot exist yet.
        let longest =
            [main.until("two slow calls", |_, after| after > SLOW * 2), main.until_showing()];
        assert!(longest.iter().all(|iteration| *iteration < LONGEST_ITERATION), "{longest:?}");
        assert_eq!(main.headset.validation_messages(), 0);
    } else if alone_in_network() {
        let mut runtime = Runtime::start();
        runtime.report_blend_modes("opaque");
        runtime.slow = Some(SLOW);
        runtime.run_client();
    }
}

/// The headset's device has no memory for the bits of a large sculpture: it is drawn in the fallback mode,
/// as in the window, and the connection is kept.
#[test]
fn a_device_without_memory_for_the_sculpture_shows_it_in_another_mode() {
    if is_client() {
        // 512^3 voxels are 16 MiB on the device.
        let mut main = MainLoop::new(512);
        main.until_showing();
        let mode = |main: &MainLoop| main.workspace.ui.view.mode;
        main.until("another mode", |main, _| mode(main) == RenderMode::Ray);
        let messages = main.messages();
        assert!(messages.iter().any(|text| text.contains("not enough memory")), "{messages:?}");
        main.until("a second", |main, after| {
            assert!(main.headset.is_showing(), "{:?}", main.messages());
            after > Duration::from_secs(1)
        });
        let messages = main.messages();
        assert!(!messages.iter().any(|text| text.contains("No headset")), "{messages:?}");
        assert_eq!(main.headset.validation_messages(), 0);
    } else if alone_in_network() {
        let mut runtime = Runtime::start();
        // VK_ERROR_OUT_OF_DEVICE_MEMORY.
        runtime.faults = Some("allocate -2 8388608".to_owned());
        runtime.run_client();
    }
}

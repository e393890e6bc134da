//! What runtimes and devices do wrong: none of it stops the window or costs the connection.

use std::time::Duration;

use virtual_sculpture::render::RenderMode;

use super::runtime::{Runtime, alone_in_network, is_client, stop_service};
use super::wearer::Wearer;

/// Longer than is waited for within a frame for pictures and for the tracker, and what a busy machine
/// adds.
const TURN: Duration = Duration::from_millis(700);
/// How long a slow runtime takes for each call by which it is reached.
const SLOW: Duration = Duration::from_millis(1500);

#[test]
fn a_runtime_that_stops_holds_up_no_window() {
    if is_client() {
        let mut wearer = Wearer::new(32);
        wearer.until_showing();
        for round in 0..4 {
            stop_service(true);
            let longest = [
                wearer.until("silence", |wearer, _| !wearer.headset.is_showing()),
                wearer.until("half a second", |_, after| after > Duration::from_millis(500)),
            ];
            stop_service(false);
            assert!(longest.iter().all(|turn| *turn < TURN), "{longest:?} in round {round}");
            wearer.until_showing();
        }
        assert_eq!(wearer.headset.validation_messages(), 0);
    } else if alone_in_network() {
        Runtime::start().run_client();
    }
}

#[test]
fn a_runtime_that_takes_seconds_to_connect_holds_up_no_window() {
    if is_client() {
        let mut wearer = Wearer::new(32);
        // Nothing of the connection can be there yet.
        let longest = [
            wearer.until("the time it takes", |_, after| after > SLOW * 2),
            wearer.until_showing(),
        ];
        assert!(longest.iter().all(|turn| *turn < TURN), "{longest:?}");
        assert_eq!(wearer.headset.validation_messages(), 0);
    } else if alone_in_network() {
        let mut runtime = Runtime::start();
        runtime.pretend("opaque");
        runtime.slow = Some(SLOW);
        runtime.run_client();
    }
}

/// The headset's device has no memory for the bits of a large sculpture: it is drawn in the next best
/// mode, as in the window, and the connection stays.
#[test]
fn a_device_without_memory_for_the_sculpture_shows_it_in_another_mode() {
    if is_client() {
        // 512^3 voxels are 16 MiB on the device.
        let mut wearer = Wearer::new(512);
        wearer.until_showing();
        let mode = |wearer: &Wearer| wearer.workspace.ui.view.mode;
        wearer.until("another mode", |wearer, _| mode(wearer) == RenderMode::Ray);
        let told = wearer.messages();
        assert!(told.iter().any(|text| text.contains("not enough memory")), "{told:?}");
        wearer.until("a second", |wearer, after| {
            assert!(wearer.headset.is_showing(), "{:?}", wearer.messages());
            after > Duration::from_secs(1)
        });
        let told = wearer.messages();
        assert!(!told.iter().any(|text| text.contains("No headset")), "{told:?}");
        assert_eq!(wearer.headset.validation_messages(), 0);
    } else if alone_in_network() {
        let mut runtime = Runtime::start();
        // VK_ERROR_OUT_OF_DEVICE_MEMORY.
        runtime.faults = Some("allocate -2 8388608".to_owned());
        runtime.run_client();
    }
}

//! The device of the tests.

use std::sync::{Arc, Once};

use virtual_sculpture::gpu::{Device, DeviceChoice, DeviceOptions, Headless, Validation};

/// Runs `test` with a headless device, then checks that the validation layers had nothing to
/// say, the device's end included. `VS_TEST_DEVICE` chooses the device, as in the configuration;
/// with `VS_REQUIRE_VALIDATION=1` the layers must be there, and the device, without which the test is
/// skipped else.
pub fn with_device(test: impl FnOnce(&Arc<Device>)) {
    let choice = std::env::var("VS_TEST_DEVICE").unwrap_or_default();
    let required = std::env::var("VS_REQUIRE_VALIDATION").is_ok_and(|value| value == "1");
    let validation = if required { Validation::Required } else { Validation::IfAvailable };
    let choice = DeviceChoice::parse(&choice);
    let options = DeviceOptions { choice, validation, ..DeviceOptions::default() };
    let device = Device::new(&mut Headless, &options)
        .unwrap_or_else(|error| trials::lacks("VS_REQUIRE_VALIDATION", &error.to_string()));
    warn_without_validation(&device);
    let log = device.validation_log().clone();
    test(&device);
    assert_eq!(Arc::strong_count(&device), 1, "something keeps the device alive");
    drop(device);
    let count = log.count();
    assert!(
        count == 0,
        "the validation layers have {count} complaints, first {:#?}",
        log.messages().first()
    );
}

/// Skips the running test where there is no Vulkan device, or fails it with `VS_REQUIRE_VALIDATION=1`: for tests
/// that start the program, which needs one.
pub fn need_device() {
    with_device(|_| ());
}

fn warn_without_validation(device: &Device) {
    static SAID: Once = Once::new();
    if !device.instance().validated() {
        SAID.call_once(|| {
            eprintln!(
                "WARNING: the Vulkan validation layer is not installed, so these tests do not \
                 check our use of Vulkan (Debian, Ubuntu: vulkan-validationlayers)"
            );
        });
    }
}

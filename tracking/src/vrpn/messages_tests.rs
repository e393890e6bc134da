//! Tests of payloads: they survive a round trip, and broken ones are refused.

use super::*;
use proptest::prelude::*;

fn f() -> impl Strategy<Value = f64> {
    -1.0e6..1.0e6f64
}

fn vec3() -> impl Strategy<Value = DVec3> {
    [f(), f(), f()].prop_map(DVec3::from_array)
}

fn quat() -> impl Strategy<Value = DQuat> {
    [f(), f(), f(), f()].prop_map(DQuat::from_array)
}

fn message() -> impl Strategy<Value = Message> {
    prop_oneof![
        (0..MAX_SENSORS, vec3(), quat()).prop_map(|(sensor, position_m, quat)| Message::Pose {
            sensor,
            position_m,
            quat
        }),
        (0..MAX_SENSORS, vec3(), quat(), f()).prop_map(|(sensor, linear, quat, dt_s)| {
            Message::Velocity { sensor, linear, quat, dt_s }
        }),
        (0..MAX_SENSORS, vec3(), quat(), f()).prop_map(|(sensor, linear, quat, dt_s)| {
            Message::Acceleration { sensor, linear, quat, dt_s }
        }),
        (vec3(), quat()).prop_map(|(position_m, quat)| Message::ToRoom { position_m, quat }),
        (0..9u32, vec3(), quat()).prop_map(|(sensor, position_m, quat)| Message::UnitToSensor {
            sensor,
            position_m,
            quat
        }),
        (vec3(), vec3()).prop_map(|(min_m, max_m)| Message::Workspace { min_m, max_m }),
        f().prop_map(|rate_hz| Message::SetUpdateRate { rate_hz }),
        (0..256u32, any::<bool>())
            .prop_map(|(button, pressed)| Message::ButtonChange { button, pressed }),
        prop::collection::vec(any::<bool>(), 0..=256).prop_map(Message::ButtonStates),
        prop::collection::vec(f(), 0..=128).prop_map(Message::Analog),
        (0..256u32, f()).prop_map(|(dial, revolutions)| Message::Dial { dial, revolutions }),
        (0..3u32, 0..9u32, "[ -~]{0,500}").prop_map(|(severity, level, text)| Message::Text {
            severity,
            level,
            text
        }),
        Just(Message::Ping),
        Just(Message::Pong),
        Just(Message::RequestToRoom),
        Just(Message::RequestUnitToSensor),
        Just(Message::RequestWorkspace),
        Just(Message::ResetOrigin),
    ]
}

proptest! {
    #[test]
    fn messages_come_back(message in message()) {
        prop_assert!(message.is_sendable());
        prop_assert_eq!(Message::decode(message.kind(), &message.encode()), Ok(message));
    }

    #[test]
    fn no_payload_of_another_length_passes(message in message(), cut in 1usize..8, more in 1usize..8) {
        let whole = message.encode();
        let kind = message.kind();
        if kind != MessageKind::Text {
            if whole.len() >= cut {
                prop_assert!(Message::decode(kind, &whole[..whole.len() - cut]).is_err());
            }
            let mut longer = whole.clone();
            longer.resize(whole.len() + more, 0);
            prop_assert!(Message::decode(kind, &longer).is_err());
        }
    }

    #[test]
    fn not_a_number_is_refused_wherever_it_stands(message in message(), place in any::<usize>(), bad in 0usize..3) {
        let mut payload = message.encode();
        let value = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][bad];
        // Offsets of the first and last number of each kind.
        let (begin, end) = match message.kind() {
            MessageKind::Pose
            | MessageKind::UnitToSensor
            | MessageKind::Velocity
            | MessageKind::Acceleration => (8, payload.len()),
            MessageKind::ToRoom
            | MessageKind::Workspace
            | MessageKind::Analog
            | MessageKind::SetUpdateRate => (0, payload.len()),
            MessageKind::Dial => (0, 8),
            _ => (0, 0),
        };
        if begin < end {
            let at = begin + place % ((end - begin) / 8) * 8;
            payload[at..at + 8].copy_from_slice(&value.to_be_bytes());
            prop_assert!(Message::decode(message.kind(), &payload).is_err());
        }
    }
}

#[test]
fn counts_and_indices_are_bounded() {
    let states = |count: u32, bytes: usize| {
        let mut payload = count.to_be_bytes().to_vec();
        payload.resize(4 + bytes, 0);
        Message::decode(MessageKind::ButtonStates, &payload)
    };
    assert_eq!(states(2, 8), Ok(Message::ButtonStates(vec![false; 2])));
    assert!(states(3, 8).is_err() && states(257, 4 * 257).is_err() && states(u32::MAX, 8).is_err());
    for count in [129.0, -1.0, 0.5, 1.0e18] {
        let payload: Vec<u8> = f64::to_be_bytes(count).into_iter().chain([0; 1032]).collect();
        assert_eq!(
            Message::decode(MessageKind::Analog, &payload),
            Err(MessageError::Index(MessageKind::Analog))
        );
    }
    let change = |button: i32| {
        let mut payload = button.to_be_bytes().to_vec();
        payload.extend([0, 0, 0, 1]);
        Message::decode(MessageKind::ButtonChange, &payload)
    };
    assert!(change(255).is_ok() && change(256).is_err() && change(-1).is_err());
    assert!(!Message::Analog(vec![0.0; 129]).is_sendable());
    assert!(!Message::Analog(vec![f64::NAN]).is_sendable());
    assert!(!Message::Dial { dial: 256, revolutions: 0.0 }.is_sendable());
}

#[test]
fn texts_short_long_and_torn() {
    let text = |bytes: &[u8]| {
        let mut payload = vec![0, 0, 0, 2, 0, 0, 0, 9];
        payload.extend_from_slice(bytes);
        Message::decode(MessageKind::Text, &payload)
    };
    let of = |text: &str| Ok(Message::Text { severity: 2, level: 9, text: text.to_owned() });
    assert_eq!(text(b"\0"), of(""));
    assert_eq!(text(b"short\0\xff\xfejunk"), of("short"));
    assert_eq!(text(b"\xffx\0"), of("\u{fffd}x"));
    assert!(text(b"no end").is_err() && text(b"").is_err());
    assert!(text(&[b'a'; 5000]).is_err());
    let long = Message::Text { severity: 0, level: 0, text: "b".repeat(5000) }.encode();
    assert_eq!(long.len(), 1032);
    assert!(Message::decode(MessageKind::Text, &long).is_ok());
}

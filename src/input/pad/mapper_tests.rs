use super::*;
use proptest::prelude::*;

const RESPONSE: Response = Response { dead_zone: 0.1, curve: 2.0 };
const PAD: PadId = PadId(0);
const OTHER: PadId = PadId(1);
const APPLY: Action = Action::Apply;

fn bindings() -> Bindings {
    Bindings::presets().unwrap().remove(0)
}

fn mapper(mode: PadMode) -> PadMapper {
    let mut mapper = PadMapper::new(RESPONSE, mode);
    mapper.came(PAD, "one".to_string());
    mapper.came(OTHER, "two".to_string());
    mapper
}

fn holding(buttons: &[PadButton]) -> PadState {
    let held = buttons.iter().fold(PadButtons::NONE, |set, button| set.with(*button));
    PadState { held, ..PadState::default() }
}

fn pushing(x: f32, y: f32) -> PadState {
    PadState { left: Vec2::new(x, y), ..PadState::default() }
}

/// Returns the shift of all glides among `events`, in seconds at full speed.
fn shift(events: &[PadEvent]) -> Vec3 {
    let each = events.iter().map(|event| match event {
        PadEvent::Glide(glide) => glide.shift,
        _ => Vec3::ZERO,
    });
    each.sum()
}

proptest! {
    /// Checks that the stick moves something equally far at every frame rate.
    #[test]
    fn the_displacement_does_not_depend_on_the_rate_of_pictures(
        pushes in prop::collection::vec((-1.0f32..1.0, -1.0f32..1.0, 0.01f64..0.3), 1..12),
        rates in prop::collection::vec(3.0f64..240.0, 2..4),
    ) {
        let bindings = bindings();
        let displacements: Vec<Vec3> = rates.iter().map(|rate| {
            let mut mapper = mapper(PadMode::UseTool);
            let (mut now_s, mut picture_s, mut displacement) = (1.0, 1.0, Vec3::ZERO);
            let states = pushes.iter().map(|&(x, y, s)| (pushing(x, y), s));
            for (state, lasts_s) in states.chain([(PadState::default(), 1.0)]) {
                mapper.update(PAD, state, now_s, &bindings);
                now_s += lasts_s;
                while picture_s < now_s {
                    displacement += shift(&mapper.take(picture_s, &bindings));
                    picture_s += 1.0 / rate;
                }
            }
            displacement
        }).collect();
        let expected: Vec3 = pushes.iter()
            .map(|&(x, y, s)| (RESPONSE.speed(Vec2::new(x, y)) * s as f32).extend(0.0))
            .sum();
        for displacement in displacements {
            prop_assert!(displacement.abs_diff_eq(expected, 1e-3), "{} {}", displacement, expected);
        }
    }
}

#[test]
fn three_modes_follow_one_another() {
    let bindings = bindings();
    let mut mapper = mapper(PadMode::OnlyMouse);
    let mut modes = Vec::new();
    for i in 0..4 {
        modes.push(mapper.mode().label());
        mapper.update(PAD, holding(&[PadButton::East]), f64::from(i), &bindings);
        mapper.update(PAD, holding(&[]), f64::from(i) + 0.1, &bindings);
    }
    assert_eq!(modes, ["Pointer mode", "Tool mode", "Sculpture mode", "Pointer mode"]);
}

#[test]
fn the_tool_moves_before_between_and_after_press_and_release() {
    let bindings = bindings();
    let mut mapper = mapper(PadMode::UseTool);
    let mut pressing = pushing(1.0, 0.0);
    mapper.update(PAD, pressing, 1.0, &bindings);
    pressing.held = PadButtons::NONE.with(PadButton::South);
    mapper.update(PAD, pressing, 1.1, &bindings);
    assert!(mapper.is_holding() && mapper.is_active());
    mapper.update(PAD, pushing(1.0, 0.0), 1.2, &bindings);
    let events = mapper.take(1.4, &bindings);
    assert!(!mapper.is_holding());
    let [
        PadEvent::Glide(before),
        PadEvent::Action(ActionEvent::Begin { action: APPLY, at: None }),
        PadEvent::Glide(during),
        PadEvent::Action(ActionEvent::End(APPLY)),
        PadEvent::Glide(after),
    ] = events[..]
    else {
        panic!("{events:?}")
    };
    let displacements = [before, during, after].map(|glide| glide.shift.x);
    assert!(
        std::iter::zip(displacements, [0.1, 0.1, 0.2])
            .all(|(a, b): (f32, f32)| (a - b).abs() < 1e-4)
    );
    mapper.update(PAD, PadState::default(), 1.4, &bindings);
    assert!(!mapper.is_active(), "a pad at rest needs no pictures");
    assert_eq!(mapper.take(9.0, &bindings), []);
}

#[test]
fn sticks_and_shoulders_have_their_axes() {
    let bindings = bindings();
    let glide = |state: PadState| {
        let mut mapper = mapper(PadMode::MoveGrid);
        mapper.update(PAD, state, 1.0, &bindings);
        match mapper.take(1.25, &bindings)[..] {
            [PadEvent::Glide(glide)] => (glide.shift * 4.0, glide.turn * 4.0),
            ref other => panic!("{other:?}"),
        }
    };
    let right = |x, y| PadState { right: Vec2::new(x, y), ..PadState::default() };
    let pull = |x, y| PadState { triggers: Vec2::new(x, y), ..PadState::default() };
    assert_eq!(glide(pushing(-1.0, 0.0)), (Vec3::NEG_X, Vec3::ZERO));
    assert_eq!(glide(pushing(0.0, 1.0)), (Vec3::Y, Vec3::ZERO));
    assert_eq!(glide(right(1.0, 0.0)), (Vec3::ZERO, Vec3::Y));
    assert_eq!(glide(right(0.0, 1.0)), (Vec3::ZERO, Vec3::NEG_X));
    assert_eq!(glide(holding(&[PadButton::LeftShoulder])), (Vec3::NEG_Z, Vec3::ZERO));
    assert_eq!(glide(pull(1.0, 0.0)), (Vec3::Z, Vec3::ZERO));
    assert_eq!(glide(holding(&[PadButton::RightShoulder])), (Vec3::ZERO, Vec3::NEG_Z));
    assert_eq!(glide(pull(0.0, 1.0)), (Vec3::ZERO, Vec3::Z));
    let half = glide(pull(0.55, 0.0)).0.z;
    assert!((half - 0.25).abs() < 1e-4, "half the way behind the dead zone, squared: {half}");
}

#[test]
fn a_bound_shoulder_moves_nothing() {
    let bound = "name = \"t\"\ntext = \"\"\n[bindings]\nsave = [\"pad-left-shoulder\"]";
    let bindings = Bindings::parse(bound).unwrap();
    let mut mapper = mapper(PadMode::UseTool);
    mapper.update(PAD, holding(&[PadButton::LeftShoulder]), 1.0, &bindings);
    let events = mapper.take(1.2, &bindings);
    assert_eq!(events, [PadEvent::Action(ActionEvent::Tap(Action::Save))]);
    assert!(!mapper.is_active());
}

#[test]
fn in_mouse_mode_two_buttons_click() {
    let bindings = bindings();
    let mut mapper = mapper(PadMode::OnlyMouse);
    mapper.update(PAD, holding(&[PadButton::South]), 1.0, &bindings);
    mapper.update(PAD, holding(&[PadButton::North]), 1.1, &bindings);
    assert!(mapper.is_holding());
    mapper.update(PAD, holding(&[PadButton::DpadLeft]), 1.2, &bindings);
    mapper.update(PAD, holding(&[]), 1.3, &bindings);
    let undo = PadEvent::Action(ActionEvent::Tap(Action::Undo));
    let events = mapper.take(1.3, &bindings);
    assert_eq!(
        events,
        [PadEvent::DoubleClick, PadEvent::Press(true), PadEvent::Press(false), undo]
    );
}

#[test]
fn held_buttons_ask_again_where_that_makes_sense() {
    let bindings = bindings();
    let taps = |button, seconds: f64| {
        let mut mapper = mapper(PadMode::UseTool);
        mapper.update(PAD, holding(&[button]), 1.0, &bindings);
        let pictures = (0..(seconds * 60.0) as u32).map(|i| 1.0 + f64::from(i) / 60.0);
        pictures.map(|now_s| mapper.take(now_s, &bindings).len()).sum::<usize>()
    };
    assert_eq!(taps(PadButton::DpadLeft, 0.3), 1);
    assert_eq!(taps(PadButton::DpadLeft, 1.0), 7);
    assert_eq!(taps(PadButton::West, 1.0), 1);
}

#[test]
fn switching_going_and_losing_the_keyboard_release_what_is_held() {
    let bindings = bindings();
    let end = PadEvent::Action(ActionEvent::End(APPLY));
    let held = || {
        let mut mapper = mapper(PadMode::UseTool);
        mapper.update(PAD, holding(&[PadButton::South]), 1.0, &bindings);
        assert_eq!(mapper.take(1.0, &bindings).len(), 1);
        mapper
    };
    let mut switched = held();
    switched.next_mode();
    assert_eq!(switched.take(1.1, &bindings), [end]);

    let mut gone = held();
    assert_eq!(gone.went(PAD).as_deref(), Some("one"));
    assert_eq!(gone.take(1.1, &bindings), [end]);
    assert_eq!(gone.leader(), Some((OTHER, "two")));
    assert_eq!(gone.went(PAD), None);

    let mut deaf = held();
    deaf.set_listening(false);
    assert_eq!(deaf.take(1.1, &bindings), [end]);
    deaf.update(PAD, pushing(1.0, 0.0), 1.2, &bindings);
    deaf.update(PAD, holding(&[PadButton::South]), 1.3, &bindings);
    assert!(!deaf.is_active());
    deaf.set_listening(true);
    deaf.update(PAD, holding(&[PadButton::South]), 1.4, &bindings);
    assert_eq!(
        deaf.take(1.5, &bindings),
        [],
        "pressed elsewhere, it counts only when pressed anew"
    );
}

#[test]
fn the_pad_used_last_leads() {
    let bindings = bindings();
    let mut mapper = mapper(PadMode::UseTool);
    mapper.update(PAD, holding(&[PadButton::South]), 1.0, &bindings);
    mapper.update(OTHER, pushing(0.05, 0.0), 1.1, &bindings);
    assert_eq!(mapper.leader(), Some((PAD, "one")), "a stick that is not quite at rest");
    mapper.update(OTHER, pushing(1.0, 0.0), 1.2, &bindings);
    assert_eq!(mapper.leader(), Some((OTHER, "two")));
    let events = mapper.take(1.3, &bindings);
    assert!(events.contains(&PadEvent::Action(ActionEvent::End(APPLY))));
    assert!((shift(&events).x - 0.1).abs() < 1e-4);
}

#[test]
fn a_long_pause_between_pictures_does_not_fling_the_tool_away() {
    let bindings = bindings();
    let mut mapper = mapper(PadMode::UseTool);
    mapper.update(PAD, pushing(1.0, 0.0), 1.0, &bindings);
    for i in 0..100 {
        // A shaky thumb causes many events in that time.
        let x = if i % 2 == 0 { 1.0 } else { 1.0 - f32::EPSILON };
        mapper.update(PAD, pushing(x, 0.0), 1.0 + f64::from(i) * 0.2, &bindings);
    }
    let displacement = shift(&mapper.take(21.0, &bindings));
    assert!((displacement.x - 0.5).abs() < 1e-3, "{displacement}");
    let displacement = shift(&mapper.take(21.1, &bindings));
    assert!((displacement.x - 0.1).abs() < 1e-3, "{displacement}");
}

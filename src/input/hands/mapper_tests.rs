//! Tests of the mapper: sequences of controller states and the events that they give.

use super::*;
use glam::{Quat, Vec3};

const REACH_M: f32 = 0.1;

fn mapper(main: HandSide) -> HandMapper {
    let response = Response { dead_zone: 0.2, curve: 1.0 };
    HandMapper::new(HandSettings { main, response, reach_m: REACH_M })
}

/// Hands at rest before the person; time passes with every frame.
struct Person {
    state: HandsState,
    mapper: HandMapper,
    board: Option<Board>,
}

impl Person {
    fn new(main: HandSide) -> Person {
        let mut state = HandsState::default();
        for (hand, x) in state.hands.iter_mut().zip([-0.2, 0.2]) {
            let pose = RoomPose { position: Vec3::new(x, 1.3, -0.4), rotation: Quat::IDENTITY };
            (hand.grip, hand.aim) = (Some(pose), Some(pose));
        }
        let mut person = Person { state, mapper: mapper(main), board: None };
        assert!(matches!(person.frame()[..], [HandEvent::Tool(_)]), "the tool comes to the hand");
        person
    }

    fn hand(&mut self, side: HandSide) -> &mut super::super::HandState {
        &mut self.state.hands[side.index()]
    }

    fn shift(&mut self, side: HandSide, by: Vec3) {
        let hand = self.hand(side);
        for pose in [&mut hand.grip, &mut hand.aim].into_iter().flatten() {
            pose.position += by;
        }
    }

    fn frame(&mut self) -> Vec<HandEvent> {
        self.frame_after(1.0 / 64.0)
    }

    fn frame_after(&mut self, dt_s: f64) -> Vec<HandEvent> {
        self.state.time_s += dt_s;
        self.mapper.update(&self.state, self.board.as_ref())
    }
}

use HandSide::{Left, Right};

#[test]
fn the_trigger_uses_the_tool_where_the_hand_is() {
    for main in HandSide::ALL {
        let mut person = Person::new(main);
        assert_eq!(person.frame(), [], "a hand at rest has no events");
        person.shift(main, Vec3::new(0.0, 0.0, -0.05));
        let there = person.hand(main).aim.unwrap().at(Vec3::NEG_Z * REACH_M);
        let events = person.frame();
        let [HandEvent::Tool(tool)] = events[..] else { panic!("{events:?}") };
        assert!(tool.position.abs_diff_eq(there, 1e-6));
        person.hand(main).trigger = 1.0;
        let events = person.frame();
        let [HandEvent::Tool(tool), HandEvent::Press] = events[..] else { panic!("{events:?}") };
        assert!(tool.position.abs_diff_eq(there, 1e-6));
        assert!(
            matches!(person.frame()[..], [HandEvent::Tool(_)]),
            "the tool follows the hand during a stroke"
        );
        person.hand(main).trigger = 0.0;
        assert!(matches!(person.frame()[..], [HandEvent::Tool(_), HandEvent::Release]));
    }
}

#[test]
fn a_hand_that_is_no_longer_tracked_releases_the_tool() {
    let mut person = Person::new(Right);
    person.hand(Right).trigger = 1.0;
    person.frame();
    person.hand(Right).aim = None;
    assert_eq!(person.frame(), [HandEvent::Release]);
    person.hand(Right).aim = Some(RoomPose { position: Vec3::NAN, rotation: Quat::IDENTITY });
    assert_eq!(person.frame(), []);
}

#[test]
fn a_jump_lifts_the_tool_until_the_hand_is_slow() {
    let mut person = Person::new(Right);
    person.hand(Right).trigger = 1.0;
    person.frame();
    person.shift(Right, Vec3::X * 0.5);
    assert!(matches!(person.frame()[..], [HandEvent::Release, HandEvent::Tool(_)]));
    assert_eq!(person.frame(), [], "lifted, and at rest");
    person.shift(Right, Vec3::X * 0.05);
    assert!(matches!(person.frame()[..], [HandEvent::Tool(_)]), "it follows the hand");
    let events = person.frame_after(0.1);
    let [HandEvent::Tool(tool), HandEvent::Press] = events[..] else { panic!("{events:?}") };
    assert!((tool.position.x - 0.75).abs() < 1e-5);
    // Pulled while the hand is not trusted, and released before it is again.
    person.shift(Right, Vec3::X * -0.5);
    assert!(matches!(person.frame()[..], [HandEvent::Release, HandEvent::Tool(_)]));
    person.hand(Right).trigger = 0.0;
    assert_eq!(person.frame_after(0.2), []);
    // Only part of a pause counts, so it does not permit every distance.
    person.hand(Right).trigger = 1.0;
    person.frame();
    person.shift(Right, Vec3::X * 0.7);
    assert!(matches!(person.frame_after(2.0)[..], [HandEvent::Release, HandEvent::Tool(_)]));
}

#[test]
fn a_carried_sculpture_does_not_follow_a_jump() {
    let mut person = Person::new(Right);
    person.hand(Left).squeeze = 1.0;
    person.frame();
    person.shift(Left, Vec3::X * 0.3);
    assert_eq!(person.frame(), [], "0.3 m in a 64th of a second");
    person.shift(Left, Vec3::X * 0.05);
    assert!(matches!(person.frame()[..], [HandEvent::Carry(_), HandEvent::Tool(_)]));
}

#[test]
fn grips_carry_and_both_scale() {
    let mut person = Person::new(Right);
    person.hand(Left).squeeze = 1.0;
    assert_eq!(person.frame(), []);
    assert!(person.mapper.is_carrying());
    person.shift(Left, Vec3::X * 0.1);
    let events = person.frame();
    let [HandEvent::Carry(by), HandEvent::Tool(_)] = events[..] else { panic!("{events:?}") };
    assert!(by.translation.abs_diff_eq(Vec3::X * 0.1, 1e-6) && by.scale == 1.0);
    person.hand(Right).squeeze = 1.0;
    person.frame();
    // From 0.3 m to 0.6 m apart.
    person.shift(Right, Vec3::X * 0.3);
    let events = person.frame_after(0.1);
    let [HandEvent::Carry(by), HandEvent::Tool(_)] = events[..] else { panic!("{events:?}") };
    assert!((by.scale - 2.0).abs() < 1e-4);
    person.hand(Left).squeeze = 0.0;
    person.hand(Right).squeeze = 0.0;
    person.frame();
    assert!(!person.mapper.is_carrying());
}

#[test]
fn without_a_grip_the_off_trigger_carries_and_a_tap_opens_the_board() {
    let mut person = Person::new(Right);
    person.hand(Left).trigger = 1.0;
    person.frame();
    person.hand(Left).trigger = 0.0;
    assert_eq!(person.frame(), [HandEvent::ToggleBoard]);
    person.hand(Left).trigger = 1.0;
    person.frame();
    person.frame_after(TAP_S);
    person.shift(Left, Vec3::Y * 0.1);
    assert!(matches!(person.frame()[..], [HandEvent::Carry(_), HandEvent::Tool(_)]));
    person.hand(Left).trigger = 0.0;
    assert_eq!(person.frame(), [], "a hold is no tap");
}

#[test]
fn sticks_resize_the_tool_and_undo_and_redo() {
    let mut person = Person::new(Left);
    person.hand(Left).stick = Vec2::new(0.0, 1.0);
    let events = person.frame_after(0.0625);
    let [HandEvent::Resize(notches)] = events[..] else { panic!("{events:?}") };
    assert!((notches - 0.0625 * RESIZE_PER_S).abs() < 1e-4);
    let events = person.frame_after(10.0);
    let [HandEvent::Resize(notches)] = events[..] else { panic!("{events:?}") };
    assert!(notches <= LONGEST_STEP_S as f32 * RESIZE_PER_S + 1e-4, "no jump after a pause");
    person.hand(Left).stick = Vec2::ZERO;

    person.hand(Right).stick.x = -0.9;
    assert_eq!(person.frame(), [HandEvent::Undo]);
    assert_eq!(person.frame(), [], "once per push");
    assert_eq!(person.frame_after(REPEAT_AFTER_S), [HandEvent::Undo], "repeats while it is held");
    person.hand(Right).stick.x = 0.9;
    assert_eq!(person.frame(), [], "on its travel through the middle");
    assert_eq!(person.frame(), [HandEvent::Redo]);
    person.hand(Right).stick.x = f32::NAN;
    assert_eq!(person.frame(), []);
}

#[test]
fn a_menu_button_opens_the_board_and_recentres_when_held() {
    for side in HandSide::ALL {
        let mut person = Person::new(Right);
        person.hand(side).menu = true;
        assert_eq!(person.frame(), []);
        person.hand(side).menu = false;
        assert_eq!(person.frame(), [HandEvent::ToggleBoard]);
        person.hand(side).menu = true;
        person.frame();
        assert_eq!(person.frame_after(LONG_S), [HandEvent::Recentre]);
        assert_eq!(person.frame_after(LONG_S), [], "once");
        person.hand(side).menu = false;
        assert_eq!(person.frame(), [], "and no tap");
    }
}

#[test]
fn over_the_board_the_trigger_clicks_and_the_stick_scrolls() {
    let mut person = Person::new(Right);
    // Straight in front of the right hand.
    let pose = RoomPose { position: Vec3::new(0.2, 1.3, -0.8), rotation: Quat::IDENTITY };
    person.board = Some(Board { pose, size_m: Vec2::new(0.4, 0.2) });
    person.hand(Right).trigger = 1.0;
    let events = person.frame();
    let [HandEvent::Point(at), HandEvent::Click(true)] = events[..] else { panic!("{events:?}") };
    assert!(at.abs_diff_eq(Vec2::splat(0.5), 1e-5));
    // Dragged off the board: the press still belongs to the board.
    person.shift(Right, Vec3::X);
    assert!(matches!(person.frame()[..], [HandEvent::PointAway, HandEvent::Tool(_)]));
    person.hand(Right).trigger = 0.0;
    assert_eq!(person.frame(), [HandEvent::Click(false)]);

    person.shift(Right, Vec3::NEG_X);
    person.hand(Right).stick = Vec2::new(0.0, -1.0);
    let events = person.frame();
    let [HandEvent::Point(_), HandEvent::Scroll(by)] = events[..] else { panic!("{events:?}") };
    assert!(by.y < 0.0 && by.x == 0.0, "downwards shows what is below");
}

#[test]
fn a_pull_that_turns_the_hand_points_where_it_began() {
    let mut person = Person::new(Right);
    let pose = RoomPose { position: Vec3::new(0.2, 1.3, -0.8), rotation: Quat::IDENTITY };
    person.board = Some(Board { pose, size_m: Vec2::new(0.4, 0.2) });
    let turn = |person: &mut Person, degrees: f32| {
        let rotation = Quat::from_rotation_y(degrees.to_radians());
        person.hand(Right).aim.as_mut().unwrap().rotation = rotation;
    };
    let middle = HandEvent::Point(Vec2::splat(0.5));
    assert!(matches!(person.frame()[..], [HandEvent::Point(_)]));
    // A pull of a second, in which the hand rotates by half a degree and back.
    let mut events = Vec::new();
    for i in 0..=64 {
        let travel = (i as f32 / 32.0).min(2.0 - i as f32 / 32.0);
        person.hand(Right).trigger = travel;
        turn(&mut person, -0.5 * travel);
        events.extend(person.frame());
    }
    events.dedup();
    let around = |event: &HandEvent| match (event, middle) {
        // Half a degree is 0.009.
        (HandEvent::Point(a), HandEvent::Point(b)) => a.abs_diff_eq(b, 1e-3),
        _ => false,
    };
    let begun = events.iter().position(|event| *event == HandEvent::Click(true)).unwrap();
    let ended = events.iter().position(|event| *event == HandEvent::Click(false)).unwrap();
    assert!(begun < ended, "{events:?}");
    let mut points = events[..=ended].iter().filter(|event| matches!(event, HandEvent::Point(_)));
    assert!(points.all(around), "{events:?}");
    // Pressed at once, like a button.
    turn(&mut person, 0.0);
    person.frame();
    person.hand(Right).trigger = 1.0;
    turn(&mut person, 0.7);
    let events = person.frame();
    assert!(around(&events[0]) && events[1] == HandEvent::Click(true), "{events:?}");
    // Farther than pulling rotates the hand, it drags, and keeps dragging.
    turn(&mut person, 3.0);
    assert!(!around(&person.frame()[0]));
    turn(&mut person, 0.5);
    let events = person.frame();
    let [HandEvent::Point(at)] = events[..] else { panic!("{events:?}") };
    assert!((at.x - 0.5).abs() > 0.005, "the ray of a drag is not held still: {at}");
    person.hand(Right).trigger = 0.0;
    person.frame();
    // A finger that rests on the trigger does not hold the ray still.
    person.hand(Right).trigger = 0.3;
    person.frame();
    turn(&mut person, 6.0);
    let events = person.frame();
    let [HandEvent::Point(at)] = events[..] else { panic!("{events:?}") };
    turn(&mut person, 5.5);
    assert!(person.frame() != [HandEvent::Point(at)]);
}

#[test]
fn a_button_of_the_main_hand_picks_a_colour() {
    let mut person = Person::new(Right);
    person.hand(Right).pick = true;
    assert_eq!(person.frame(), [HandEvent::Pick]);
    person.hand(Right).trigger = 1.0;
    assert!(!person.frame().contains(&HandEvent::Pick), "not in a stroke");
    person.hand(Right).trigger = 0.0;
    person.hand(Right).pick = false;
    person.hand(Left).pick = true;
    assert!(!person.frame().contains(&HandEvent::Pick), "the other hand has no tool");
}

#[test]
fn a_stroke_that_has_begun_continues_in_front_of_the_board() {
    let mut person = Person::new(Right);
    person.hand(Right).trigger = 1.0;
    person.frame();
    let pose = RoomPose { position: Vec3::new(0.2, 1.3, -0.8), rotation: Quat::IDENTITY };
    person.board = Some(Board { pose, size_m: Vec2::new(0.4, 0.2) });
    assert!(matches!(person.frame()[..], [HandEvent::Tool(_)]));
    person.hand(Right).trigger = 0.0;
    // It points at the board once the stroke is over.
    assert!(matches!(person.frame()[..], [HandEvent::Tool(_), HandEvent::Release]));
    assert!(matches!(person.frame()[..], [HandEvent::Point(_)]));
}

#[test]
fn everything_is_released_when_the_hands_change_roles() {
    let mut person = Person::new(Right);
    person.hand(Right).trigger = 1.0;
    person.frame();
    let mut events = Vec::new();
    person.mapper.set_main(Right, &mut events);
    assert_eq!(events, [], "nothing changes");
    person.mapper.set_main(Left, &mut events);
    assert_eq!(events, [HandEvent::Release]);
    person.hand(Right).trigger = 0.0;
    person.hand(Left).trigger = 1.0;
    let events = person.frame();
    let [HandEvent::Tool(tool), HandEvent::Tool(_), HandEvent::Press] = events[..] else {
        panic!("{events:?}")
    };
    assert!(tool.position.x < 0.0, "the left hand has the tool");
}

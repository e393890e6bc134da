//! Absurd poses of hands from a headset lead to finite results.

use glam::{Quat, Vec2, Vec3};
use virtual_sculpture::input::hands::{
    Board, HandEvent, HandMapper, HandSettings, HandSide, HandState, HandsState,
};
use virtual_sculpture::input::pad::stick::Response;
use virtual_sculpture::view::RoomPose;

struct Dice(u64);

impl Dice {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) % end
    }

    /// Mostly a number between -2 and 2, sometimes one that breaks things.
    fn number(&mut self) -> f32 {
        const NASTY: [f32; 10] = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN,
            f32::MIN_POSITIVE,
            1e-40,
            0.0,
            -0.0,
            1e18,
        ];
        match self.below(12) {
            0 => NASTY[self.below(NASTY.len() as u64) as usize],
            1 => f32::from_bits(self.below(1 << 32) as u32),
            _ => self.below(4001) as f32 / 1000.0 - 2.0,
        }
    }

    fn pose(&mut self) -> Option<RoomPose> {
        let position = Vec3::new(self.number(), self.number(), self.number());
        let [x, y, z, w] = [0; 4].map(|_: u8| self.number());
        let rotation = match self.below(3) {
            0 => Quat::from_xyzw(x, y, z, w),
            _ => Quat::from_xyzw(x, y, z, w).normalize(),
        };
        (self.below(8) > 0).then_some(RoomPose { position, rotation })
    }

    fn hand(&mut self) -> HandState {
        HandState {
            grip: self.pose(),
            aim: self.pose(),
            trigger: self.number(),
            squeeze: self.number(),
            stick: Vec2::new(self.number(), self.number()),
            menu: self.below(4) == 0,
            pick: self.below(4) == 0,
        }
    }
}

fn is_finite(event: &HandEvent) -> bool {
    let pose = |pose: &RoomPose| pose.position.is_finite() && pose.rotation.is_finite();
    match event {
        HandEvent::Carry(carried) => {
            carried.scale.is_finite()
                && carried.rotation.is_finite()
                && carried.translation.is_finite()
        }
        HandEvent::Tool(at) => pose(at),
        HandEvent::Resize(notches) => notches.is_finite(),
        HandEvent::Pressure(pressure) => (0.0..=1.0).contains(pressure),
        HandEvent::Point(at) => at.is_finite(),
        HandEvent::Scroll(by) => by.is_finite(),
        HandEvent::Press
        | HandEvent::Release
        | HandEvent::Pick
        | HandEvent::Undo
        | HandEvent::Redo
        | HandEvent::ToggleBoard
        | HandEvent::Recentre
        | HandEvent::PointAway
        | HandEvent::Click(_) => true,
    }
}

/// `VS_FUZZ_RUNS=N` makes it N states.
#[test]
fn whatever_a_headset_says_of_hands_events_are_finite() {
    let runs = std::env::var("VS_FUZZ_RUNS").map_or(30_000, |runs| runs.parse().unwrap());
    let mut dice = Dice(0x5eed);
    let mut mapper = HandMapper::new(HandSettings {
        main: HandSide::Right,
        response: Response { dead_zone: 0.2, curve: 2.0 },
        reach_m: 0.08,
    });
    let board = Board { pose: RoomPose::default(), size_m: Vec2::new(0.4, 0.3) };
    let (mut time_s, mut events) = (0.0, 0);
    for run in 0..runs {
        time_s += match dice.below(30) {
            // The clock of the headset jumps.
            0 => dice.below(2000) as f64 - 1000.0,
            _ => 0.011,
        };
        let told_s = match dice.below(60) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            _ => time_s,
        };
        let state = HandsState { time_s: told_s, hands: [dice.hand(), dice.hand()] };
        for event in mapper.update(&state, (dice.below(2) == 0).then_some(&board)) {
            assert!(is_finite(&event), "run {run}: {event:?} from {state:?}");
            events += 1;
        }
    }
    assert!(events > runs / 10, "{events} events");
}

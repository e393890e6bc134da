//! Connected gamepads: a thread that sleeps until one of them has an event, through gilrs, and the motors for rumble.
//!
//! Returns [`PadNews`]; does not know their purpose.

use std::thread;
use std::time::Instant;

use gilrs::ff::{BaseEffect, BaseEffectType, Effect, EffectBuilder, Repeat, Replay, Ticks};
use gilrs::{Axis, Button, EventType, Gamepad, GamepadId, Gilrs, GilrsBuilder};
use glam::Vec2;

use super::{PadButton, PadButtons, PadId, PadState};

/// An event of a pad.
#[derive(Debug)]
pub struct PadNews {
    pub pad: PadId,
    pub at: Instant,
    pub change: PadChange,
}

#[derive(Debug)]
pub enum PadChange {
    Came {
        name: String,
        /// `None` if the pad has no motors.
        motor: Option<Box<dyn Motor>>,
    },
    Went,
    State(PadState),
}

/// The motors of a pad.
pub trait Motor: Send + std::fmt::Debug {
    /// Rumbles with a strength of 0 to 1 from now on. It ends soon unless the call is repeated, so that a hanging
    /// program leaves no pad rumbling.
    fn shake(&mut self, strength: f32);
}

/// Starts the thread, which calls `tell` with all events until that returns false. Connected pads come first. A system
/// without gamepad support is only logged.
pub fn listen(tell: impl Fn(PadNews) -> bool + Send + 'static) {
    let started = thread::Builder::new().name("gamepads".to_string()).spawn(move || {
        if let Err(error) = serve(&tell) {
            tracing::warn!("no gamepads: {error}");
        }
    });
    if let Err(error) = started {
        tracing::warn!("no gamepads: {error}");
    }
}

/// Opens gilrs. Its force feedback thread wakes up every 50 ms, so it is started with the first pad.
fn open(motors: bool) -> Result<Gilrs, Box<gilrs::Error>> {
    // Dead zones and D-pads are handled here and in `stick`: the filters of gilrs treat one axis at
    // a time, which distorts slow diagonal pushes.
    GilrsBuilder::new()
        .with_default_filters(false)
        .with_force_feedback(motors)
        .build()
        .map_err(Box::new)
}

fn serve(tell: &dyn Fn(PadNews) -> bool) -> Result<(), Box<gilrs::Error>> {
    let mut gilrs = open(false)?;
    while gilrs.gamepads().next().is_none() {
        gilrs.next_event_blocking(None);
    }
    gilrs = open(true)?;

    let mut known: Vec<(GamepadId, PadState)> = Vec::new();
    let there: Vec<GamepadId> = gilrs.gamepads().map(|(id, _)| id).collect();
    for id in there {
        if !tell(came(&mut gilrs, id)) {
            return Ok(());
        }
        known.push((id, PadState::default()));
    }
    loop {
        let Some(event) = gilrs.next_event_blocking(None) else { continue };
        let at = known.iter().position(|(id, _)| *id == event.id);
        let news = match (event.event, at) {
            (EventType::Connected, None) => {
                known.push((event.id, PadState::default()));
                came(&mut gilrs, event.id)
            }
            (EventType::Disconnected, Some(at)) => {
                known.swap_remove(at);
                news(event.id, PadChange::Went)
            }
            (_, Some(at)) => {
                let state = state_of(&gilrs.gamepad(event.id));
                if known[at].1 == state {
                    continue;
                }
                known[at].1 = state;
                news(event.id, PadChange::State(state))
            }
            (_, None) => continue,
        };
        if !tell(news) {
            return Ok(());
        }
    }
}

fn news(id: GamepadId, change: PadChange) -> PadNews {
    PadNews { pad: PadId(id.into()), at: Instant::now(), change }
}

fn came(gilrs: &mut Gilrs, id: GamepadId) -> PadNews {
    let name = gilrs.gamepad(id).name().to_string();
    let motor = if gilrs.gamepad(id).is_ff_supported() {
        match PadMotor::new(gilrs, id) {
            Ok(motor) => Some(Box::new(motor) as Box<dyn Motor>),
            Err(error) => {
                tracing::warn!("{name} cannot rumble: {error}");
                None
            }
        }
    } else {
        None
    };
    tracing::info!(rumble = motor.is_some(), "gamepad: {name}");
    news(id, PadChange::Came { name, motor })
}

fn state_of(pad: &Gamepad) -> PadState {
    let stick = |x, y| Vec2::new(pad.value(x), pad.value(y));
    let deflection = |button| pad.button_data(button).map_or(0.0, |data| data.value());
    // A D-pad is four buttons on some pads and two axes on others.
    let cross = [
        (PadButton::DpadLeft, Axis::DPadX, -1.0),
        (PadButton::DpadRight, Axis::DPadX, 1.0),
        (PadButton::DpadDown, Axis::DPadY, -1.0),
        (PadButton::DpadUp, Axis::DPadY, 1.0),
    ];
    let mut held = PadButtons::NONE;
    for (ours, theirs) in BUTTONS {
        if pad.is_pressed(theirs) {
            held = held.with(ours);
        }
    }
    for (button, axis, sense) in cross {
        if pad.value(axis) * sense > 0.5 {
            held = held.with(button);
        }
    }
    PadState {
        left: stick(Axis::LeftStickX, Axis::LeftStickY),
        right: stick(Axis::RightStickX, Axis::RightStickY),
        triggers: Vec2::new(deflection(Button::LeftTrigger2), deflection(Button::RightTrigger2)),
        held,
    }
}

const BUTTONS: [(PadButton, Button); 16] = [
    (PadButton::South, Button::South),
    (PadButton::East, Button::East),
    (PadButton::West, Button::West),
    (PadButton::North, Button::North),
    (PadButton::LeftShoulder, Button::LeftTrigger),
    (PadButton::RightShoulder, Button::RightTrigger),
    (PadButton::LeftTrigger, Button::LeftTrigger2),
    (PadButton::RightTrigger, Button::RightTrigger2),
    (PadButton::Select, Button::Select),
    (PadButton::Start, Button::Start),
    (PadButton::LeftStick, Button::LeftThumb),
    (PadButton::RightStick, Button::RightThumb),
    (PadButton::DpadLeft, Button::DPadLeft),
    (PadButton::DpadRight, Button::DPadRight),
    (PadButton::DpadUp, Button::DPadUp),
    (PadButton::DpadDown, Button::DPadDown),
];

/// Milliseconds after which rumble ends unless it is renewed.
const DEADLINE_MS: u32 = 300;
/// Share of the strength for the weak motor, whose vibration is finer.
const WEAK_SHARE: f32 = 0.6;

/// One effect for the lifetime of the pad: its gain is the strength.
#[derive(Debug)]
struct PadMotor {
    effect: EffectHandle,
    /// Whether the effect is playing.
    shaking: bool,
}

/// The handle of gilrs has no Debug.
struct EffectHandle(Effect);

impl std::fmt::Debug for EffectHandle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Effect")
    }
}

impl PadMotor {
    fn new(gilrs: &mut Gilrs, id: GamepadId) -> Result<PadMotor, gilrs::ff::Error> {
        let deadline = Ticks::from_ms(DEADLINE_MS);
        // Longer than the deadline: an effect plays for its whole time, without gaps between two.
        let scheduling = Replay { play_for: Ticks::from_ms(10 * DEADLINE_MS), ..Replay::default() };
        let base = |kind| BaseEffect { kind, scheduling, ..BaseEffect::default() };
        let weak = (f32::from(u16::MAX) * WEAK_SHARE) as u16;
        let effect = EffectBuilder::new()
            .add_effect(base(BaseEffectType::Strong { magnitude: u16::MAX }))
            .add_effect(base(BaseEffectType::Weak { magnitude: weak }))
            .repeat(Repeat::For(deadline))
            .gamepads(&[id])
            .finish(gilrs)?;
        Ok(PadMotor { effect: EffectHandle(effect), shaking: false })
    }
}

impl Motor for PadMotor {
    fn shake(&mut self, strength: f32) {
        let effect = &self.effect.0;
        let told = if strength > 0.0 {
            self.shaking = true;
            effect.set_gain(strength.min(1.0)).and_then(|()| effect.play())
        } else if std::mem::take(&mut self.shaking) {
            effect.stop()
        } else {
            Ok(())
        };
        if let Err(error) = told {
            tracing::debug!("rumble: {error}");
        }
    }
}

//! Bindings from raw buttons and analog channels to the program's actions: a button is an action, a channel is an axis
//! (with dead zone and sign) or a button (with hysteresis). Takes events, gives actions; does not know their meaning.

use crate::event::Event;

/// The use of an analog channel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum AnalogUse {
    /// -1 to 1. Values within `dead_zone` of 0 are 0; the rest is rescaled to start at 0.
    Axis { scale: f64, dead_zone: f64 },
    /// Pressed at `press` or above, released at `release` or below (which is less than `press`).
    Press { press: f64, release: f64 },
}

/// The action of a device's button.
#[derive(Clone, PartialEq, Debug)]
pub struct ButtonBinding<A> {
    pub source: String,
    pub button: u32,
    pub action: A,
}

/// The action of a device's channel.
#[derive(Clone, PartialEq, Debug)]
pub struct AnalogBinding<A> {
    pub source: String,
    pub channel: u32,
    pub action: A,
    pub meaning: AnalogUse,
}

/// An action of the program.
#[derive(Clone, PartialEq, Debug)]
pub enum Control<A> {
    Pressed(A),
    Released(A),
    /// -1 to 1.
    Axis(A, f64),
}

/// All bindings and their state.
#[derive(Clone, Debug)]
pub struct ControlMap<A> {
    buttons: Vec<(ButtonBinding<A>, bool)>,
    analogs: Vec<(AnalogBinding<A>, f64)>,
}

impl<A: Clone> ControlMap<A> {
    pub fn new(buttons: Vec<ButtonBinding<A>>, analogs: Vec<AnalogBinding<A>>) -> Self {
        Self {
            buttons: buttons.into_iter().map(|binding| (binding, false)).collect(),
            analogs: analogs.into_iter().map(|binding| (binding, 0.0)).collect(),
        }
    }

    /// Appends the actions of `event`. Only changes are reported; the loss of a device releases its buttons and
    /// resets its axes.
    pub fn take(&mut self, event: &Event, controls: &mut Vec<Control<A>>) {
        match event {
            Event::Button { source, button, pressed, .. } => {
                for (binding, held) in &mut self.buttons {
                    if binding.button == *button && *binding.source == **source {
                        set_held(held, *pressed, &binding.action, controls);
                    }
                }
            }
            Event::Analog { source, channel, value, .. } => {
                for (binding, state) in &mut self.analogs {
                    if binding.channel == *channel && *binding.source == **source {
                        set_analog(binding, state, *value, controls);
                    }
                }
            }
            Event::Lost { source, .. } => {
                for (binding, held) in &mut self.buttons {
                    if *binding.source == **source {
                        set_held(held, false, &binding.action, controls);
                    }
                }
                for (binding, state) in &mut self.analogs {
                    if *binding.source == **source {
                        let idle = match binding.meaning {
                            AnalogUse::Axis { .. } => 0.0,
                            AnalogUse::Press { release, .. } => release,
                        };
                        set_analog(binding, state, idle, controls);
                    }
                }
            }
            _ => {}
        }
    }
}

fn set_held<A: Clone>(held: &mut bool, now: bool, action: &A, controls: &mut Vec<Control<A>>) {
    if *held != now {
        *held = now;
        let action = action.clone();
        controls.push(if now { Control::Pressed(action) } else { Control::Released(action) });
    }
}

/// Sets an analog control. `state` is the axis' last value, or 1 and 0 for pressed and released.
fn set_analog<A: Clone>(
    binding: &AnalogBinding<A>,
    state: &mut f64,
    value: f64,
    controls: &mut Vec<Control<A>>,
) {
    match binding.meaning {
        AnalogUse::Axis { scale, dead_zone } => {
            let scaled = (value * scale).clamp(-1.0, 1.0);
            let beyond = (scaled.abs() - dead_zone).max(0.0) / (1.0 - dead_zone).max(1.0e-6);
            let axis = beyond.min(1.0).copysign(scaled);
            if axis != *state {
                *state = axis;
                controls.push(Control::Axis(binding.action.clone(), axis));
            }
        }
        AnalogUse::Press { press, release } => {
            let mut held = *state > 0.5;
            let now = if held { value > release } else { value >= press };
            set_held(&mut held, now, &binding.action, controls);
            *state = f64::from(u8::from(held));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> ControlMap<&'static str> {
        let analog = |channel, action, meaning| AnalogBinding {
            source: "Wand0".into(),
            channel,
            action,
            meaning,
        };
        ControlMap::new(
            vec![ButtonBinding { source: "Wand0".into(), button: 1, action: "apply" }],
            vec![
                analog(0, "size", AnalogUse::Axis { scale: -2.0, dead_zone: 0.2 }),
                analog(1, "grab", AnalogUse::Press { press: 0.7, release: 0.3 }),
            ],
        )
    }

    fn analog(channel: u32, value: f64) -> Event {
        Event::Analog { source: "Wand0".into(), channel, value, time_s: 0.0 }
    }

    fn take(map: &mut ControlMap<&'static str>, event: Event) -> Vec<Control<&'static str>> {
        let mut controls = Vec::new();
        map.take(&event, &mut controls);
        controls
    }

    #[test]
    fn axes_have_dead_zone_sign_and_limits() {
        let mut map = map();
        assert!(take(&mut map, analog(0, 0.05)).is_empty());
        assert!(take(&mut map, analog(7, 1.0)).is_empty());
        assert_eq!(take(&mut map, analog(0, 9.0)), [Control::Axis("size", -1.0)]);
        let mut last = -1.0;
        for i in (-50..=50).rev() {
            for control in take(&mut map, analog(0, f64::from(i) / 100.0)) {
                let Control::Axis("size", x) = control else { panic!("{control:?}") };
                assert!(x >= last && x - last < 0.03, "continuous and rising");
                last = x;
            }
        }
        assert_eq!(last, 1.0);
    }

    #[test]
    fn a_trigger_has_hysteresis() {
        let mut map = map();
        assert!(take(&mut map, analog(1, 0.6)).is_empty());
        assert_eq!(take(&mut map, analog(1, 0.7)), [Control::Pressed("grab")]);
        assert!(take(&mut map, analog(1, 0.31)).is_empty());
        assert_eq!(take(&mut map, analog(1, 0.3)), [Control::Released("grab")]);
    }

    #[test]
    fn a_lost_device_holds_nothing() {
        let mut map = map();
        let press =
            |pressed| Event::Button { source: "Wand0".into(), button: 1, pressed, time_s: 0.0 };
        assert_eq!(take(&mut map, press(true)), [Control::Pressed("apply")]);
        assert!(take(&mut map, press(true)).is_empty());
        take(&mut map, analog(0, 1.0));
        take(&mut map, analog(1, 1.0));
        let lost = Event::Lost { source: "Wand0".into(), time_s: 1.0 };
        let released = take(&mut map, lost.clone());
        assert_eq!(
            released,
            [Control::Released("apply"), Control::Axis("size", 0.0), Control::Released("grab")]
        );
        assert!(take(&mut map, lost).is_empty());
    }
}

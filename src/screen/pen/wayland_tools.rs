//! The tools of Wayland's tablets: combines their events into a report at the end of each frame.
//!
//! Pure: takes events of `zwp_tablet_tool_v2` as values and gives reports.

use glam::Vec2;

use super::{PenReport, WindowKey};
use crate::input::pen::{PenEnd, PenSample};
use crate::input::{Button, Buttons};

/// The largest pressure of the protocol.
const FULL_PRESSURE: f32 = 65535.0;

/// An event of a tool, reduced to the relevant parts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum ToolEvent {
    /// The end towards the tablet: `pen`, `eraser` and so on by the numbers of the protocol.
    Kind(u32),
    CanPress,
    Near(WindowKey),
    Away,
    Down,
    Up,
    /// In points from the corner of the window.
    Moved(Vec2),
    Pressed(u32),
    Tilted(Vec2),
    /// A button by its number in Linux's `input-event-codes.h`.
    Button {
        code: u32,
        is_down: bool,
    },
    Frame,
}

const KIND_ERASER: u32 = 0x141;
const BUTTONS: [(u32, Button); 6] = [
    (0x14b, Button::PenLower),
    (0x14c, Button::PenUpper),
    (0x149, Button::PenThird),
    // Buttons of the mice that belong to some tablets.
    (0x110, Button::Left),
    (0x111, Button::Right),
    (0x112, Button::Middle),
];

/// One end of a pen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tool {
    end: PenEnd,
    can_press: bool,
    window: Option<WindowKey>,
    is_leaving: bool,
    position: Vec2,
    pressure: u32,
    tilt_deg: Vec2,
    is_down: bool,
    buttons: Buttons,
}

impl Tool {
    /// Handles an event. Returns the report of the frame that it ends.
    pub fn take(&mut self, event: ToolEvent) -> Option<PenReport> {
        match event {
            ToolEvent::Kind(KIND_ERASER) => self.end = PenEnd::Eraser,
            ToolEvent::Kind(_) => self.end = PenEnd::Tip,
            ToolEvent::CanPress => self.can_press = true,
            ToolEvent::Near(window) => {
                (self.window, self.is_leaving) = (Some(window), false);
                (self.is_down, self.buttons, self.pressure) = (false, Buttons::NONE, 0);
            }
            ToolEvent::Away => {
                self.is_leaving = true;
                (self.is_down, self.buttons) = (false, Buttons::NONE);
            }
            ToolEvent::Down => self.is_down = true,
            ToolEvent::Up => self.is_down = false,
            ToolEvent::Moved(position) => self.position = position,
            ToolEvent::Pressed(pressure) => self.pressure = pressure,
            ToolEvent::Tilted(tilt_deg) => self.tilt_deg = tilt_deg,
            ToolEvent::Button { code, is_down } => {
                if let Some((_, button)) = BUTTONS.into_iter().find(|(known, _)| *known == code) {
                    self.buttons = match is_down {
                        true => self.buttons.with(button),
                        false => self.buttons.without(button),
                    };
                }
            }
            ToolEvent::Frame => return self.frame(),
        }
        None
    }

    fn frame(&mut self) -> Option<PenReport> {
        let window = self.window?;
        let is_near = !std::mem::take(&mut self.is_leaving);
        if !is_near {
            self.window = None;
        }
        let tip = if self.end == PenEnd::Eraser { Button::Eraser } else { Button::Left };
        let buttons = if self.is_down { self.buttons.with(tip) } else { self.buttons };
        let pressure = self.can_press.then_some(self.pressure as f32 / FULL_PRESSURE);
        let sample = PenSample {
            position_px: self.position,
            pressure,
            tilt_deg: self.tilt_deg,
            end: self.end,
            buttons,
            is_near,
        };
        sample.checked().map(|sample| PenReport { window, sample })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(tool: &mut Tool, events: &[ToolEvent]) -> Vec<PenReport> {
        events.iter().filter_map(|event| tool.take(*event)).collect()
    }

    #[test]
    fn a_frame_is_a_sample_and_what_is_over_no_window_is_none() {
        use ToolEvent::{
            Button as B, CanPress, Down, Frame, Kind, Moved, Near, Pressed, Tilted, Up,
        };
        let mut tool = Tool::default();
        assert!(run(&mut tool, &[Kind(0x140), CanPress, Moved(Vec2::ONE), Frame]).is_empty());
        let window = WindowKey::numbered(7);
        let at = Vec2::new(10.5, 20.25);
        let reports = run(
            &mut tool,
            &[
                Near(window),
                Moved(at),
                Frame,
                Down,
                Pressed(32768),
                Tilted(Vec2::new(30.0, -10.0)),
                B { code: 0x14c, is_down: true },
                B { code: 0x199, is_down: true },
                Frame,
                B { code: 0x14c, is_down: false },
                Up,
                Frame,
            ],
        );
        assert_eq!(reports.len(), 3);
        assert!(reports.iter().all(|report| report.window == window && report.sample.is_near));
        let [hover, down, up] = [0, 1, 2].map(|i| reports[i].sample);
        assert_eq!((hover.position_px, hover.buttons), (at, Buttons::NONE));
        assert_eq!(down.buttons, Buttons::NONE.with(Button::Left).with(Button::PenUpper));
        assert!((down.pressure.unwrap() - 0.5).abs() < 1e-4);
        assert_eq!(down.tilt_deg, Vec2::new(30.0, -10.0));
        assert_eq!(up.buttons, Buttons::NONE);
    }

    #[test]
    fn a_pen_that_leaves_lets_go_and_an_eraser_is_one() {
        let window = WindowKey::numbered(1);
        let mut tool = Tool::default();
        let events = [
            ToolEvent::Kind(KIND_ERASER),
            ToolEvent::Near(window),
            ToolEvent::Down,
            ToolEvent::Frame,
            ToolEvent::Away,
            ToolEvent::Frame,
            ToolEvent::Moved(Vec2::ONE),
            ToolEvent::Frame,
        ];
        let reports = run(&mut tool, &events);
        assert_eq!(reports.len(), 2, "nothing after it has left");
        assert_eq!(reports[0].sample.buttons, Buttons::NONE.with(Button::Eraser));
        assert_eq!((reports[0].sample.end, reports[0].sample.pressure), (PenEnd::Eraser, None));
        assert!(!reports[1].sample.is_near && reports[1].sample.buttons == Buttons::NONE);
    }
}

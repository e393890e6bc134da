//! The size or the strength of the tool, led by the pointer: begun by a key, as far as the pointer goes to the right or to
//! the left, until a click keeps it or Escape and the other buttons give back what was.
//!
//! Takes the action events meanwhile and says which of them are for it. Must not know keys.

use glam::Vec2;

use super::tool::{ToolKind, ToolState};
use crate::input::{Action, ActionEvent};
use crate::tools::brush::keys::STRENGTH;
use crate::tools::brush::options::BrushOptions;

/// Pixels to the right that double the size.
const DOUBLES_PX: f32 = 100.0;
/// Pixels to the right from no strength to the full one.
const FULL_PX: f32 = 250.0;

/// The number that the pointer leads.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Led {
    Size,
    Strength,
}

/// The effect of an event while the pointer leads.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Heard {
    /// It is not for the change of the tool.
    Other,
    /// It means nothing else.
    Taken,
    /// The tool is to become larger by so many notches, each of which doubles its size.
    Resize(f32),
}

/// A change of the tool that is under way, if there is one.
#[derive(Debug, Default)]
pub(super) struct Leading(Option<State>);

#[derive(Debug)]
enum State {
    Led {
        what: Led,
        /// Where the pointer was last, if it was over the picture.
        at: Option<Vec2>,
        /// As the tool was.
        before: Box<ToolState>,
    },
    /// It is over, by a button that is still pressed and means nothing else.
    Over(Action),
}

impl Leading {
    /// Returns whether the pointer leads the size or the strength of the tool.
    pub fn is_under_way(&self) -> bool {
        matches!(self.0, Some(State::Led { .. }))
    }

    /// Begins with the pointer at `at`. Refused for a tool that has no such number, with the reason.
    pub fn begin(
        &mut self,
        what: Led,
        at: Option<Vec2>,
        tool: &mut ToolState,
    ) -> Result<(), &'static str> {
        if tool.kind == ToolKind::Marker {
            return Err("Resize the marker by its faces: Ctrl and the left button");
        }
        if what == Led::Strength && with_strength(tool).is_none() {
            return Err("This tool has no strength");
        }
        self.0 = Some(State::Led { what, at, before: Box::new(tool.clone()) });
        Ok(())
    }

    /// Takes an event.
    pub fn hear(&mut self, event: &ActionEvent, tool: &mut ToolState) -> Heard {
        let (what, at) = match &mut self.0 {
            None => return Heard::Other,
            Some(State::Over(action)) => {
                let over = *action;
                if *event == ActionEvent::End(over) {
                    self.0 = None;
                }
                return match event {
                    ActionEvent::Drag { action, .. } | ActionEvent::End(action)
                        if *action == over =>
                    {
                        Heard::Taken
                    }
                    _ => Heard::Other,
                };
            }
            Some(State::Led { what, at, .. }) => (*what, at),
        };
        match *event {
            ActionEvent::Hover(to) => {
                let by_px = at.replace(to).map_or(0.0, |from| to.x - from.x);
                match what {
                    Led::Size => return Heard::Resize(by_px / DOUBLES_PX),
                    Led::Strength => {
                        if let Some(options) = with_strength(tool) {
                            let strength = options.get(STRENGTH) + by_px / FULL_PX;
                            options.set(STRENGTH, strength.clamp(0.01, 1.0));
                        }
                    }
                }
            }
            ActionEvent::Left => *at = None,
            // Any click with the button that sculpts keeps it.
            ActionEvent::Begin { action, .. } if action.is_stroke() => {
                self.0 = Some(State::Over(action));
            }
            ActionEvent::Begin { action, .. } => {
                self.give_back(tool);
                self.0 = Some(State::Over(action));
            }
            ActionEvent::Tap(Action::Cancel) => self.give_back(tool),
            // The same key again, or another action, keeps it.
            ActionEvent::Tap(action) => {
                self.0 = None;
                return match action {
                    Action::LeadSize | Action::LeadStrength => Heard::Taken,
                    _ => Heard::Other,
                };
            }
            _ => return Heard::Other,
        }
        Heard::Taken
    }

    fn give_back(&mut self, tool: &mut ToolState) {
        if let Some(State::Led { before, .. }) = self.0.take() {
            *tool = *before;
        }
    }
}

/// Returns the options of the brush in hand, if it has a strength.
fn with_strength(tool: &mut ToolState) -> Option<&mut BrushOptions> {
    let brush = tool.brush()?;
    Some(tool.brushes.of_mut(brush)).filter(|options| options.has(STRENGTH))
}

//! Sets the size or the strength of the tool with the pointer: begins with a key, follows the pointer to the right or
//! left, and ends with a click that keeps the value, or Escape or another button that restores it.
//!
//! Takes the action events meanwhile and reports which ones it uses. Must not know keys.

use glam::Vec2;

use super::tool::{ToolKind, ToolState};
use crate::input::{Action, ActionEvent};
use crate::tools::brush::keys::STRENGTH;
use crate::tools::brush::options::BrushOptions;

/// Pixels to the right that double the size.
const DOUBLES_PX: f32 = 100.0;
/// Pixels to the right from no strength to the full one.
const FULL_PX: f32 = 250.0;

/// The value that the pointer sets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Led {
    Size,
    Strength,
}

/// The effect of an event meanwhile.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum LeadEffect {
    /// The event does not concern the change of the tool.
    Other,
    /// The event is used up.
    Taken,
    /// The tool grows by so many notches, each of which doubles its size.
    Resize(f32),
}

/// A change of the tool in progress, if there is one.
#[derive(Debug, Default)]
pub(super) struct Leading(Option<LeadState>);

#[derive(Debug)]
enum LeadState {
    Led {
        what: Led,
        /// The last position of the pointer, if it was over the picture.
        at: Option<Vec2>,
        /// The tool before the change.
        before: Box<ToolState>,
    },
    /// It was ended by a button that is still pressed and has no other effect.
    Over(Action),
}

impl Leading {
    /// Returns whether the pointer sets the size or the strength of the tool.
    pub fn is_under_way(&self) -> bool {
        matches!(self.0, Some(LeadState::Led { .. }))
    }

    /// Begins with the pointer at `at`. Refused for a tool without such a value, with the reason.
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
        self.0 = Some(LeadState::Led { what, at, before: Box::new(tool.clone()) });
        Ok(())
    }

    /// Handles an event.
    pub fn hear(&mut self, event: &ActionEvent, tool: &mut ToolState) -> LeadEffect {
        let (what, at) = match &mut self.0 {
            None => return LeadEffect::Other,
            Some(LeadState::Over(action)) => {
                let over = *action;
                if *event == ActionEvent::End(over) {
                    self.0 = None;
                }
                return match event {
                    ActionEvent::Drag { action, .. } | ActionEvent::End(action)
                        if *action == over =>
                    {
                        LeadEffect::Taken
                    }
                    _ => LeadEffect::Other,
                };
            }
            Some(LeadState::Led { what, at, .. }) => (*what, at),
        };
        match *event {
            ActionEvent::Hover(to) => {
                let by_px = at.replace(to).map_or(0.0, |from| to.x - from.x);
                match what {
                    Led::Size => return LeadEffect::Resize(by_px / DOUBLES_PX),
                    Led::Strength => {
                        if let Some(options) = with_strength(tool) {
                            let strength = options.get(STRENGTH) + by_px / FULL_PX;
                            options.set(STRENGTH, strength.clamp(0.01, 1.0));
                        }
                    }
                }
            }
            ActionEvent::Left => *at = None,
            // A click with the sculpting button keeps it.
            ActionEvent::Begin { action, .. } if action.is_stroke() => {
                self.0 = Some(LeadState::Over(action));
            }
            ActionEvent::Begin { action, .. } => {
                self.give_back(tool);
                self.0 = Some(LeadState::Over(action));
            }
            ActionEvent::Tap(Action::Cancel) => self.give_back(tool),
            // The same key again, or another action, keeps it.
            ActionEvent::Tap(action) => {
                self.0 = None;
                return match action {
                    Action::LeadSize | Action::LeadStrength => LeadEffect::Taken,
                    _ => LeadEffect::Other,
                };
            }
            _ => return LeadEffect::Other,
        }
        LeadEffect::Taken
    }

    fn give_back(&mut self, tool: &mut ToolState) {
        if let Some(LeadState::Led { before, .. }) = self.0.take() {
            *tool = *before;
        }
    }
}

/// Returns the options of the brush in hand, if it has a strength.
fn with_strength(tool: &mut ToolState) -> Option<&mut BrushOptions> {
    let brush = tool.brush()?;
    Some(tool.brushes.of_mut(brush)).filter(|options| options.has(STRENGTH))
}

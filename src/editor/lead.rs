//! The size or the strength of the tool, led by the pointer: begun by a key, as far as the pointer goes to the right or to
//! the left, until a click keeps it or Escape and the other buttons give back what was.
//!
//! Takes the action events meanwhile and says which of them are for it. Must not know keys.

use glam::Vec2;

use super::Editor;
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

/// A change of the tool that is under way.
#[derive(Debug)]
pub(super) enum Leading {
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

impl Editor {
    /// Whether the pointer leads the size or the strength of the tool.
    pub fn is_leading(&self) -> bool {
        matches!(self.leading, Some(Leading::Led { .. }))
    }

    pub(super) fn begin_leading(&mut self, what: Led) {
        if self.tool.kind == ToolKind::Marker {
            self.note("Resize the marker by its faces: Ctrl and the left button");
            return;
        }
        if what == Led::Strength && self.with_strength().is_none() {
            self.note("This tool has no strength");
            return;
        }
        let before = Box::new(self.tool.clone());
        self.leading = Some(Leading::Led { what, at: self.pointer, before });
    }

    /// Takes an event while the pointer leads; true if it means nothing else.
    pub fn lead_by(&mut self, event: &ActionEvent) -> bool {
        let (what, at) = match &mut self.leading {
            None => return false,
            Some(Leading::Over(action)) => {
                let over = *action;
                if *event == ActionEvent::End(over) {
                    self.leading = None;
                }
                return matches!(event, ActionEvent::Drag { action, .. } | ActionEvent::End(action) if *action == over);
            }
            Some(Leading::Led { what, at, .. }) => (*what, at),
        };
        match *event {
            ActionEvent::Hover(to) => {
                let by_px = at.replace(to).map_or(0.0, |from| to.x - from.x);
                match what {
                    Led::Size => self.resize(by_px / DOUBLES_PX, 2.0),
                    Led::Strength => {
                        if let Some(options) = self.with_strength() {
                            let strength = options.get(STRENGTH) + by_px / FULL_PX;
                            options.set(STRENGTH, strength.clamp(0.01, 1.0));
                        }
                    }
                }
            }
            ActionEvent::Left => *at = None,
            // Any click with the button that sculpts keeps it.
            ActionEvent::Begin { action, .. } if action.is_stroke() => {
                self.leading = Some(Leading::Over(action));
            }
            ActionEvent::Begin { action, .. } => {
                self.give_back();
                self.leading = Some(Leading::Over(action));
            }
            ActionEvent::Tap(Action::Cancel) => self.give_back(),
            // The same key again, or another action, keeps it.
            ActionEvent::Tap(action) => {
                self.leading = None;
                return matches!(action, Action::LeadSize | Action::LeadStrength);
            }
            _ => return false,
        }
        true
    }

    fn give_back(&mut self) {
        if let Some(Leading::Led { before, .. }) = self.leading.take() {
            self.tool = *before;
        }
    }

    /// The options of the brush in hand, if it has a strength.
    fn with_strength(&mut self) -> Option<&mut BrushOptions> {
        let brush = self.tool.brush()?;
        Some(self.tool.brushes.of_mut(brush)).filter(|options| options.has(STRENGTH))
    }
}

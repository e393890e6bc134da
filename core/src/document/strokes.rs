//! The open stroke of a document, and the tool uses that an array repeats.
//!
//! Takes the events of strokes and tools; returns the uses for an array to repeat. Changes no voxel.

use glam::IVec3;

use super::CommandError;
use crate::command::Command;
use crate::refusal::InvalidValue;
use crate::sculpture::Grid;
use crate::tools::brush::BrushSurface;

/// Maximum number of copies in an array.
pub const MAX_ARRAY: u32 = 1024;
/// Maximum number of tool uses that an array repeats or makes.
pub const MAX_REPEATED: usize = 1 << 14;

/// The open stroke, and the last operation.
#[derive(Debug, Default)]
pub(super) struct Strokes {
    /// Label of the open stroke.
    label: Option<String>,
    /// The grid before the first spray of the open stroke that works on that surface.
    surface: Option<Box<Grid>>,
    /// The tool uses so far in the open stroke, with signed coordinates; empty while none is open. A use that replaces the
    /// earlier ones of its stroke replaces them here, too. Holds at most one more than [`MAX_REPEATED`].
    uses: Vec<Command>,
    /// The tool uses that an array would repeat: those of the last ended stroke in which a tool was used, the one of a
    /// later use outside a stroke, or those of a later array with the uses that it repeated. Those of the open stroke
    /// are not among them. Empty if there was none since the sculpture was created or replaced, or if an undo, a redo
    /// or a reorientation has followed. An array refuses more than [`MAX_REPEATED`].
    last_uses: Vec<Command>,
}

impl Strokes {
    pub fn is_open(&self) -> bool {
        self.label.is_some()
    }

    /// Returns the label of the open stroke.
    pub fn label(&self) -> Option<&str> {
        self.label.as_deref()
    }

    pub fn open(&mut self, label: String) {
        self.label = Some(label);
    }

    /// Closes the stroke. If a tool was used in it, it becomes the last operation. Returns its label.
    pub fn end(&mut self) -> String {
        self.surface = None;
        if !self.uses.is_empty() {
            std::mem::swap(&mut self.uses, &mut self.last_uses);
            self.uses.clear();
        }
        self.label.take().unwrap_or_default()
    }

    /// Closes the stroke as if it had never been opened.
    pub fn cancel(&mut self) {
        self.label = None;
        self.surface = None;
        self.uses.clear();
    }

    /// Returns the surface at the beginning of the stroke, if it was kept.
    pub fn surface(&self) -> Option<&Grid> {
        self.surface.as_deref()
    }

    /// Returns an open stroke with a surface of its own.
    pub fn with_surface(surface: Option<Grid>) -> Strokes {
        Strokes { label: Some(String::new()), surface: surface.map(Box::new), ..Strokes::default() }
    }

    /// Replaces the surface at the beginning of the stroke, since the box has moved, and returns the former one.
    pub fn swap_surface(&mut self, surface: Option<Grid>) -> Option<Grid> {
        std::mem::replace(&mut self.surface, surface.map(Box::new)).map(|former| *former)
    }

    /// Keeps the present surface for the rest of the open stroke, unless an earlier one is kept.
    pub fn keep_surface(&mut self, grid: &Grid) -> Result<(), CommandError> {
        if self.is_open() && self.surface.is_none() {
            self.surface = Some(Box::new(grid.clone()));
        }
        Ok(())
    }

    /// Remembers a tool use for arrays.
    pub fn note_use(&mut self, command: &Command) {
        let replaces = matches!(command, Command::Brush(used) if used.replaces_stroke());
        let used = match command {
            // A copy in an array does not replace the ones before it.
            Command::Brush(used) if replaces => Command::Brush(used.clone().on(BrushSurface::Now)),
            _ => command.clone(),
        };
        let is_alone = !self.is_open();
        let uses = if is_alone { &mut self.last_uses } else { &mut self.uses };
        if replaces || is_alone {
            uses.clear();
        }
        if uses.len() <= MAX_REPEATED {
            uses.push(used);
        }
    }

    /// Returns the tool uses of the last operation.
    pub fn last_uses(&self) -> &[Command] {
        &self.last_uses
    }

    /// Makes these tool uses the last operation. An empty list means no last operation.
    pub fn set_last_uses(&mut self, uses: Vec<Command>) {
        self.last_uses = uses;
    }

    /// Forgets the last operation.
    pub fn forget_last_uses(&mut self) {
        self.last_uses.clear();
    }

    /// Takes the last operation in order to repeat it `count` times.
    pub fn take_last_uses(&mut self, count: u32) -> Result<Vec<Command>, CommandError> {
        match self.last_uses.len() {
            0 => Err(CommandError::NothingToRepeat),
            n if n > MAX_REPEATED => Err(CommandError::TooLongToRepeat),
            n if count == 0 || count > MAX_ARRAY || n * count as usize > MAX_REPEATED => {
                let rule = format!(
                    "must have 1 to {MAX_ARRAY} copies and at most {MAX_REPEATED} uses of a tool in all"
                );
                Err(InvalidValue::new("array", rule, count).into())
            }
            _ => Ok(std::mem::take(&mut self.last_uses)),
        }
    }

    /// Joins these tool uses and the last operation, which has followed them, into one operation.
    pub fn join_last_uses(&mut self, before: Vec<Command>) {
        self.last_uses.splice(0..0, before);
    }
}

/// Returns the copies that an array makes of `uses`, each further by `step`; an error in place of one that cannot be
/// repeated.
pub(super) fn copies(
    uses: &[Command],
    count: u32,
    step: IVec3,
) -> impl Iterator<Item = Result<Command, CommandError>> {
    (1..=count).flat_map(move |i| {
        let by = step.saturating_mul(IVec3::splat(i as i32));
        uses.iter().map(move |used| used.shifted(by).ok_or(CommandError::NothingToRepeat))
    })
}

//! The open stroke of a document, and the uses of tools that an array repeats.
//!
//! Takes what happens to strokes and tools, gives what an array is to repeat. Changes no voxel.

use glam::IVec3;

use super::CommandError;
use crate::command::Command;
use crate::refusal::InvalidValue;
use crate::sculpture::Grid;
use crate::tools::brush::BrushSurface;

/// Most copies in an array.
pub const MAX_ARRAY: u32 = 1024;
/// Most uses of tools that an array repeats or makes.
pub const MAX_REPEATED: usize = 1 << 14;

/// The open stroke, and the last operation.
#[derive(Debug, Default)]
pub(super) struct Strokes {
    /// Label of the open stroke.
    label: Option<String>,
    /// The grid before the open stroke's first spray that asked for it.
    surface: Option<Box<Grid>>,
    /// Uses of tools in the open stroke, and those of the last operation.
    uses: Vec<Command>,
    last_uses: Vec<Command>,
}

impl Strokes {
    pub fn is_open(&self) -> bool {
        self.label.is_some()
    }

    /// Label of the open stroke.
    pub fn label(&self) -> Option<&str> {
        self.label.as_deref()
    }

    pub fn open(&mut self, label: String) {
        self.label = Some(label);
    }

    /// Closes the stroke and makes it the last operation, if a tool was used in it. Returns its label.
    pub fn end(&mut self) -> String {
        self.surface = None;
        if !self.uses.is_empty() {
            std::mem::swap(&mut self.uses, &mut self.last_uses);
            self.uses.clear();
        }
        self.label.take().unwrap_or_default()
    }

    /// Closes the stroke as if it had not been.
    pub fn cancel(&mut self) {
        self.label = None;
        self.surface = None;
        self.uses.clear();
    }

    /// The surface when the stroke began, if it was kept.
    pub fn surface(&self) -> Option<&Grid> {
        self.surface.as_deref()
    }

    /// Keeps the present surface for what follows in the open stroke, unless an earlier one is kept.
    pub fn keep_surface(&mut self, grid: &Grid) -> Result<(), CommandError> {
        if self.is_open() && self.surface.is_none() {
            self.surface = Some(Box::new(grid.copied()?));
        }
        Ok(())
    }

    /// Remembers a use of a tool for arrays.
    pub fn note_use(&mut self, command: &Command) {
        let replaces = matches!(command, Command::Brush(used) if used.replaces_stroke());
        let used = match command {
            // A copy in an array does not take the place of those before it.
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

    /// The uses of tools in the last operation.
    pub fn last_uses(&self) -> &[Command] {
        &self.last_uses
    }

    /// Makes these uses of tools the last operation; without any there is none.
    pub fn set_last_uses(&mut self, uses: Vec<Command>) {
        self.last_uses = uses;
    }

    /// There is no last operation any more.
    pub fn forget_last_uses(&mut self) {
        self.last_uses.clear();
    }

    /// Takes the last operation to repeat it so many times.
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

    /// Makes one operation of these uses of tools and the last operation, which has followed them.
    pub fn join_last_uses(&mut self, before: Vec<Command>) {
        self.last_uses.splice(0..0, before);
    }
}

/// The copies that an array makes of `uses`, each further by `step`; an error in place of one that cannot be repeated.
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

//! Undo steps as bytes, without loss: labels, states, brick records (up to the order of their bricks), whole contents,
//! orientations and kinds of surface are read back exactly as written. Used for journals, saved histories and the
//! history on disk.
//!
//! A step is, little-endian: its state (two u64), a byte for the kind of its change (1 whole, 2 oriented, 3 oriented
//! with the sculpture before, 4 surface, 6 bricks, 7 canvas, 8 several; 5 and 0, bricks in earlier layouts, are only
//! read), the label (u32 length and UTF-8 bytes), an orientation for kinds 2 and 3 or a kind of surface for kind 4 (u32
//! length and the bytes of its text form), then the record for kinds 6, 5 and 0, packed by `blocks`, or a .vsc file for
//! kinds 1 and 3. Kinds 7 and 8: `canvas`.
//!
//! Reading checks a step against the [`ContentsShape`] of the contents with which it will be swapped, so that no damaged step
//! can break a sculpture.

mod blocks;
mod canvas;
mod colours;
mod record;

use std::io::{BufRead, Read, Write};
use std::sync::Arc;

use glam::UVec3;

use self::blocks::cut;
use self::record::Layout;
use super::{FormatError, Texts, vsc};
use crate::sculpture::history::{Contents, HistorySnapshot, State, Step, StepChange, SurfaceKind};
use crate::sculpture::orientation::Orientation;
use crate::sculpture::{ColourDepth, Limits};

/// The shape of contents, which records of undo steps must match.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ContentsShape {
    /// Size in voxels.
    pub dims: UVec3,
    /// Bits of colour per voxel.
    pub depth: ColourDepth,
}

impl ContentsShape {
    /// Returns the shape of `contents`.
    pub fn of(contents: &Contents) -> ContentsShape {
        ContentsShape { dims: contents.grid.dims(), depth: contents.material.depth() }
    }

    /// Returns the shape of the contents that result from reversing `change` on contents of this shape. A step in a
    /// store does not reveal it.
    pub fn after(self, change: &StepChange) -> ContentsShape {
        match change {
            StepChange::Bricks(_) | StepChange::Surface(_) | StepChange::Stored(_) => self,
            StepChange::Whole(contents) => ContentsShape::of(contents),
            StepChange::Oriented { before: Some(contents), .. } => ContentsShape::of(contents),
            StepChange::Canvas { back, .. } => ContentsShape { dims: back.dims, ..self },
            StepChange::Several(parts) => {
                parts.iter().rev().fold(self, |shape, part| shape.after(part))
            }
            StepChange::Oriented { back, before: None } => {
                ContentsShape { dims: back.size(self.dims), ..self }
            }
        }
    }
}

/// Packs a step.
pub fn write_step(step: &Step) -> Result<Vec<u8>, FormatError> {
    let mut out = Vec::new();
    write_step_to(step, &mut out)?;
    Ok(out)
}

/// Packs a step to a writer, a record in portions.
pub(crate) fn write_step_to(step: &Step, out: &mut dyn Write) -> Result<(), FormatError> {
    if let StepChange::Stored(stored) = &step.change {
        let packed = stored.0.packed().map_err(std::io::Error::other)?;
        return Ok(out.write_all(&packed)?);
    }
    out.write_all(&step.state.sculpture.to_le_bytes())?;
    out.write_all(&step.state.number.to_le_bytes())?;
    out.write_all(&[kind_of(&step.change)])?;
    put_text(&step.label, out)?;
    write_change(&step.change, out)
}

fn kind_of(change: &StepChange) -> u8 {
    match change {
        StepChange::Bricks(_) => 6,
        StepChange::Whole(_) => 1,
        StepChange::Oriented { before: None, .. } => 2,
        StepChange::Oriented { before: Some(_), .. } => 3,
        StepChange::Surface(_) => 4,
        StepChange::Canvas { .. } => 7,
        StepChange::Several(_) => 8,
        // Of no known kind: a step in a store is copied as a whole.
        StepChange::Stored(_) => u8::MAX,
    }
}

/// Packs what follows the label.
fn write_change(change: &StepChange, out: &mut dyn Write) -> Result<(), FormatError> {
    match change {
        StepChange::Bricks(record) => record::write(record, out)?,
        StepChange::Whole(contents) => vsc::write_to(contents, &Texts::default(), &(), out)?,
        StepChange::Oriented { back, before } => {
            put_text(&back.to_string(), out)?;
            if let Some(contents) = before {
                vsc::write_to(contents, &Texts::default(), &(), out)?;
            }
        }
        StepChange::Surface(kind) => put_text(kind.name(), out)?,
        StepChange::Canvas { back, before } => canvas::write(back, before.as_deref(), out)?,
        StepChange::Several(parts) => canvas::write_parts(parts, out)?,
        StepChange::Stored(_) => {}
    }
    Ok(())
}

/// Unpacks a step that will be reversed from contents of `shape`, within the limits for contents.
pub fn read_step(
    mut bytes: &[u8],
    shape: ContentsShape,
    limits: &Limits,
) -> Result<Step, FormatError> {
    read_step_from(&mut bytes, shape, limits)
}

/// Unpacks a step as [`read_step`] does, from a reader that ends with the step; a record in portions.
pub(crate) fn read_step_from(
    rest: &mut dyn BufRead,
    shape: ContentsShape,
    limits: &Limits,
) -> Result<Step, FormatError> {
    let [sculpture, number] = [take_u64(rest)?, take_u64(rest)?];
    let mut kind = [0];
    rest.read_exact(&mut kind).map_err(cut)?;
    let [kind] = kind;
    let label = take_text(rest)?;
    let change = read_change(kind, rest, shape, limits)?;
    Ok(Step { label, change, state: State { sculpture, number } })
}

/// Unpacks what follows the label of a step of a kind.
fn read_change(
    kind: u8,
    rest: &mut dyn BufRead,
    shape: ContentsShape,
    limits: &Limits,
) -> Result<StepChange, FormatError> {
    let whole = |rest: &mut dyn BufRead| -> Result<Box<Contents>, FormatError> {
        let mut file = Vec::new();
        rest.read_to_end(&mut file)?;
        Ok(Box::new(vsc::read(&file, limits, &())?.0))
    };
    let nothing_follows = |rest: &mut dyn BufRead| match rest.fill_buf()?.len() {
        0 => Ok(()),
        trailing => Err(FormatError::Trailing(trailing as u64)),
    };
    Ok(match kind {
        0 => StepChange::Bricks(record::read(rest, shape, Layout::Linear)?),
        5 => StepChange::Bricks(record::read(rest, shape, Layout::Pages)?),
        6 => StepChange::Bricks(record::read(rest, shape, Layout::Cubes)?),
        1 => StepChange::Whole(whole(rest)?),
        2 | 3 => {
            let text = take_text(rest)?;
            let back: Orientation = text
                .parse()
                .map_err(|_| FormatError::Damaged("an orientation is of no known kind"))?;
            let before = if kind == 3 { Some(whole(rest)?) } else { None };
            nothing_follows(rest)?;
            let turned = back.size(shape.dims);
            if before.as_ref().is_some_and(|before| before.grid.dims() != turned) {
                return Err(FormatError::Damaged("an orientation does not fit its sculpture"));
            }
            StepChange::Oriented { back, before }
        }
        4 => {
            let text = take_text(rest)?;
            nothing_follows(rest)?;
            let named = SurfaceKind::NAMED.into_iter().find(|(_, name)| *name == text);
            let unknown = FormatError::Damaged("a surface is of no known kind");
            StepChange::Surface(named.ok_or(unknown)?.0)
        }
        7 => canvas::read(rest, limits)?,
        8 => StepChange::Several(canvas::read_parts(rest, shape, limits)?),
        _ => return Err(FormatError::Damaged("an undo step is of no known kind")),
    })
}

/// Unpacks the steps of a history around contents of `shape`: the undo steps and the redo steps, each with the nearest
/// to the present first.
pub(crate) fn read_steps<B: AsRef<[u8]>>(
    [undo, redo]: [&[B]; 2],
    shape: ContentsShape,
    limits: &Limits,
) -> Result<HistorySnapshot, FormatError> {
    let read = |steps: &[B]| -> Result<Vec<Arc<Step>>, FormatError> {
        let mut shape = shape;
        let mut read = Vec::with_capacity(steps.len());
        for bytes in steps {
            let step = read_step(bytes.as_ref(), shape, limits)?;
            shape = shape.after(&step.change);
            read.push(Arc::new(step));
        }
        read.reverse();
        Ok(read)
    };
    Ok(HistorySnapshot { undo: read(undo)?, redo: read(redo)? })
}

fn put_text(text: &str, out: &mut dyn Write) -> std::io::Result<()> {
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(text.as_bytes())
}

fn take_u64(rest: &mut dyn BufRead) -> Result<u64, FormatError> {
    let mut bytes = [0; 8];
    rest.read_exact(&mut bytes).map_err(cut)?;
    Ok(u64::from_le_bytes(bytes))
}

fn take_text(rest: &mut dyn BufRead) -> Result<String, FormatError> {
    let mut length = [0; 4];
    rest.read_exact(&mut length).map_err(cut)?;
    let length = u64::from(u32::from_le_bytes(length));
    // Never allocates more than there is.
    let mut text = Vec::new();
    rest.take(length).read_to_end(&mut text)?;
    match text.len() as u64 == length {
        true => Ok(String::from_utf8_lossy(&text).into_owned()),
        false => Err(FormatError::Damaged("an undo step ends too early")),
    }
}

#[cfg(test)]
mod tests;

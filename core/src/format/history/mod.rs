//! Undo steps as bytes, exactly: what is read back equals what was written in labels, states, brick records
//! (to the order of their bricks), whole contents and orientations. Used for journals; made so that saved
//! files and a history on disk can use it, too.
//!
//! A step is, little-endian: its state (two u64), a byte for the kind of its change (0 bricks, 1 whole,
//! 2 oriented, 3 oriented with the sculpture before), the label (u32 and so many bytes of UTF-8), an
//! orientation of kinds 2 and 3 (u32 and so many bytes of its text form), then the record of kind 0, packed
//! by [`blocks`], or a .vsc file of kinds 1 and 3.
//!
//! Reading checks a step against the [`Shape`] of the contents that it will be swapped with, so that no
//! damaged step can break a sculpture.

mod blocks;
mod record;

use std::borrow::Cow;
use std::sync::Arc;

use glam::UVec3;

use super::{FormatError, Texts, vsc};
use crate::sculpture::history::{Change, Contents, HistorySnapshot, State, Step};
use crate::sculpture::orientation::Orientation;
use crate::sculpture::{ColourDepth, Limits};

const CUT: FormatError = FormatError::Damaged("an undo step ends too early");

/// What the records of undo steps must fit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Shape {
    /// Size in voxels.
    pub dims: UVec3,
    /// Bits of colour per voxel.
    pub depth: ColourDepth,
}

impl Shape {
    /// That of contents.
    pub fn of(contents: &Contents) -> Shape {
        Shape { dims: contents.grid.dims(), depth: contents.material.depth() }
    }

    /// That of the contents that reversing `change` leads to, from contents of this shape. A step in a store
    /// does not tell.
    pub fn after(self, change: &Change) -> Shape {
        match change {
            Change::Bricks(_) | Change::Stored(_) => self,
            Change::Whole(contents) => Shape::of(contents),
            Change::Oriented { before: Some(contents), .. } => Shape::of(contents),
            Change::Oriented { back, before: None } => Shape { dims: back.size(self.dims), ..self },
        }
    }
}

/// Packs a step.
pub fn write_step(step: &Step) -> Result<Vec<u8>, FormatError> {
    let mut out = Vec::new();
    out.extend_from_slice(&step.state.sculpture.to_le_bytes());
    out.extend_from_slice(&step.state.number.to_le_bytes());
    let kind = match &step.change {
        Change::Bricks(_) => 0,
        Change::Whole(_) => 1,
        Change::Oriented { before: None, .. } => 2,
        Change::Oriented { before: Some(_), .. } => 3,
        Change::Stored(stored) => {
            return stored.0.packed().map_err(|why| std::io::Error::other(why).into());
        }
    };
    out.push(kind);
    put_text(&step.label, &mut out);
    match &step.change {
        Change::Bricks(record) => record::write(record, &mut out),
        Change::Whole(contents) => out.extend(vsc::write(contents, &Texts::default(), &())?),
        Change::Oriented { back, before } => {
            put_text(&back.to_string(), &mut out);
            if let Some(contents) = before {
                out.extend(vsc::write(contents, &Texts::default(), &())?);
            }
        }
        Change::Stored(_) => {}
    }
    Ok(out)
}

/// Unpacks a step to be reversed from contents of `shape`, within the limits for contents.
pub fn read_step(bytes: &[u8], shape: Shape, limits: &Limits) -> Result<Step, FormatError> {
    let mut rest = bytes;
    let sculpture = take_u64(&mut rest)?;
    let number = take_u64(&mut rest)?;
    let (&kind, after) = rest.split_first().ok_or(CUT)?;
    rest = after;
    let label = take_text(&mut rest)?.into_owned();
    let whole = |rest: &[u8]| -> Result<Box<Contents>, FormatError> {
        Ok(Box::new(vsc::read(rest, limits, &())?.0))
    };
    let change = match kind {
        0 => Change::Bricks(record::read(rest, shape)?),
        1 => Change::Whole(whole(rest)?),
        2 | 3 => {
            let text = take_text(&mut rest)?;
            let back: Orientation = text
                .parse()
                .map_err(|_| FormatError::Damaged("an orientation is of no known kind"))?;
            let before = if kind == 3 { Some(whole(rest)?) } else { None };
            if before.is_none() && !rest.is_empty() {
                return Err(FormatError::Trailing(rest.len() as u64));
            }
            let turned = back.size(shape.dims);
            if before.as_ref().is_some_and(|before| before.grid.dims() != turned) {
                return Err(FormatError::Damaged("an orientation does not fit its sculpture"));
            }
            Change::Oriented { back, before }
        }
        _ => return Err(FormatError::Damaged("an undo step is of no known kind")),
    };
    Ok(Step { label, change, state: State { sculpture, number } })
}

/// Unpacks the steps of a history around contents of `shape`: those to undo and those to redo, each with
/// the one nearest to the present first.
pub fn read_steps<B: AsRef<[u8]>>(
    [undo, redo]: [&[B]; 2],
    shape: Shape,
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

fn put_text(text: &str, out: &mut Vec<u8>) {
    out.extend_from_slice(&(text.len() as u32).to_le_bytes());
    out.extend_from_slice(text.as_bytes());
}

fn take_u64(rest: &mut &[u8]) -> Result<u64, FormatError> {
    let (bytes, after) = rest.split_first_chunk().ok_or(CUT)?;
    *rest = after;
    Ok(u64::from_le_bytes(*bytes))
}

fn take_text<'a>(rest: &mut &'a [u8]) -> Result<Cow<'a, str>, FormatError> {
    let (bytes, after) = rest.split_first_chunk().ok_or(CUT)?;
    let (text, after) = after.split_at_checked(u32::from_le_bytes(*bytes) as usize).ok_or(CUT)?;
    *rest = after;
    Ok(String::from_utf8_lossy(text))
}

#[cfg(test)]
mod tests;

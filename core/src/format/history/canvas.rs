//! Moves of the box in undo steps, and steps of several changes, as bytes:
//!
//! - a canvas, three u32: the size to which the step leads; three i32: the signed coordinates of the first voxel there; three
//!   u32: the size of the home; a byte: 1 if the box grows with the tools. Then nothing, or a .vsc file of the sculpture
//!   to which the step leads;
//! - several changes, a u32: how many; then each, the one to be reversed first first: its kind (a byte), its length (u64)
//!   and what follows the label in a step of that kind. None of them is one of several, or a whole sculpture.
//!
//! All numbers are little-endian.

use std::io::{BufRead, Read, Write};

use glam::{IVec3, UVec3};

use super::{ContentsShape, kind_of, read_change, write_change};
use crate::format::history::blocks::cut;
use crate::format::{FormatError, Texts, vsc};
use crate::sculpture::Limits;
use crate::sculpture::canvas_frame::{Canvas, CanvasFrame};
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::history::{Contents, StepChange};

const FAULT: FormatError = FormatError::Damaged("a canvas of an undo step is not possible");
/// Most changes of one step.
const MOST_PARTS: u32 = 1 << 20;

/// Writes the move of a box.
pub fn write(
    back: &Canvas,
    before: Option<&Contents>,
    out: &mut dyn Write,
) -> Result<(), FormatError> {
    let Canvas { dims, frame } = back;
    for numbers in [dims.as_ivec3(), frame.origin, frame.home.as_ivec3()] {
        for number in numbers.to_array() {
            out.write_all(&number.to_le_bytes())?;
        }
    }
    out.write_all(&[u8::from(frame.grows)])?;
    match before {
        Some(contents) => vsc::write_to(contents, &Texts::default(), &(), out),
        None => Ok(()),
    }
}

/// Reads the move of a box.
pub fn read(rest: &mut dyn BufRead, limits: &Limits) -> Result<StepChange, FormatError> {
    let mut numbers = [0; 9];
    for number in &mut numbers {
        *number = take_u32(rest)?;
    }
    let mut grows = [0];
    rest.read_exact(&mut grows).map_err(cut)?;
    let three = |i: usize| UVec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
    let origin = IVec3::from(three(3).to_array().map(|number| number as i32));
    let frame = CanvasFrame { origin, home: three(6), grows: grows == [1] };
    let dims = three(0);
    let is_size = dims.min_element() > 0 && dims.max_element() <= MAX_AXIS_VX;
    if !is_size || frame.check().is_err() || grows[0] > 1 {
        return Err(FAULT);
    }
    let back = Canvas { dims, frame };
    let mut file = Vec::new();
    rest.read_to_end(&mut file)?;
    let before = match file.len() {
        0 => None,
        _ => Some(Box::new(vsc::read(&file, limits, &())?.0)),
    };
    if before.as_ref().is_some_and(|before| before.canvas() != back) {
        return Err(FAULT);
    }
    Ok(StepChange::Canvas { back, before })
}

/// Writes several changes.
pub fn write_parts(parts: &[StepChange], out: &mut dyn Write) -> Result<(), FormatError> {
    out.write_all(&(parts.len() as u32).to_le_bytes())?;
    for part in parts.iter().rev() {
        let mut packed = Vec::new();
        write_change(part, &mut packed)?;
        out.write_all(&[kind_of(part)])?;
        out.write_all(&(packed.len() as u64).to_le_bytes())?;
        out.write_all(&packed)?;
    }
    Ok(())
}

/// Reads several changes that will be reversed from contents of `shape`.
pub fn read_parts(
    rest: &mut dyn BufRead,
    mut shape: ContentsShape,
    limits: &Limits,
) -> Result<Vec<StepChange>, FormatError> {
    const KINDS: FormatError = FormatError::Damaged("a part of an undo step is of no known kind");
    let count = take_u32(rest)?;
    if count > MOST_PARTS {
        return Err(FAULT);
    }
    let mut parts = Vec::new();
    for _ in 0..count {
        let (mut kind, mut length) = ([0], [0; 8]);
        rest.read_exact(&mut kind).map_err(cut)?;
        rest.read_exact(&mut length).map_err(cut)?;
        if !matches!(kind[0], 6 | 7) {
            return Err(KINDS);
        }
        let length = u64::from_le_bytes(length);
        // Never allocates more than there is.
        let mut packed = Vec::new();
        rest.take(length).read_to_end(&mut packed)?;
        if packed.len() as u64 != length {
            return Err(FormatError::Damaged("an undo step ends too early"));
        }
        let part = read_change(kind[0], &mut &packed[..], shape, limits)?;
        shape = shape.after(&part);
        parts.push(part);
    }
    match rest.fill_buf()?.len() {
        0 => {
            parts.reverse();
            Ok(parts)
        }
        trailing => Err(FormatError::Trailing(trailing as u64)),
    }
}

fn take_u32(rest: &mut dyn BufRead) -> Result<u32, FormatError> {
    let mut bytes = [0; 4];
    rest.read_exact(&mut bytes).map_err(cut)?;
    Ok(u32::from_le_bytes(bytes))
}

//! Reads the `.vox` of Voxlap and SLAB6, an older format with the same extension: three lengths, a byte per voxel, and
//! a palette of 6 bits per channel. z points down.

use glam::I64Vec3;

use super::model::{Model, Sink};
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::format::error::excerpt;
use crate::sculpture::Rgb;
use crate::sculpture::orientation::Up;

/// The byte of a voxel that does not exist.
const EMPTY: u8 = 255;

/// A file.
#[derive(Debug)]
pub struct Voxlap<'a> {
    size: I64Vec3,
    /// The voxels, z fastest, then y, then x.
    voxels: &'a [u8],
    palette: &'a [[u8; 3]],
}

/// Reads a file. It has no signature, so its length must exactly match its sizes.
pub fn read(file: &[u8]) -> Result<Voxlap<'_>, FormatError> {
    let mut bytes = Bytes::new(file);
    let mut parse = || {
        let size = [bytes.u32().ok()?, bytes.u32().ok()?, bytes.u32().ok()?];
        let voxels = size.iter().try_fold(1usize, |n, edge| n.checked_mul(*edge as usize))?;
        let body = bytes.rest();
        (voxels > 0 && body.len() == voxels.checked_add(768)?).then_some((size, voxels, body))
    };
    let Some((size, voxels, body)) = parse() else {
        return Err(FormatError::NotVox(excerpt(file)));
    };
    let (palette, _) = body[voxels..].as_chunks();
    let size = I64Vec3::from_array(size.map(i64::from));
    Ok(Voxlap { size, voxels: &body[..voxels], palette })
}

impl Model for Voxlap<'_> {
    fn kind(&self) -> String {
        "Voxlap".to_string()
    }

    fn up(&self) -> Up {
        Up::MinusZ
    }

    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)> {
        Some((I64Vec3::new(0, -self.size.z, 0), I64Vec3::new(self.size.x, 0, self.size.y)))
    }

    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError> {
        let I64Vec3 { y: height, z: depth, .. } = self.size;
        for (i, &colour) in (0..).zip(self.voxels) {
            if colour != EMPTY {
                let (x, y, z) = (i / (height * depth), i / depth % height, i % depth);
                let six_bits = self.palette[usize::from(colour)];
                let rgb = six_bits.map(|level| (u16::from(level.min(63)) * 255 / 63) as u8);
                sink(I64Vec3::new(x, -1 - z, y), Rgb(rgb))?;
            }
        }
        Ok(())
    }
}

//! Reads Qubicle's `.qb`: matrices of coloured voxels, plain or as runs, y up.

use glam::I64Vec3;

use super::model::{Model, ModelReader, Sink};
use super::qb_write::{self, RUN, SLICE_END};
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::format::spec::{Export, FormatSpec, Import};
use crate::sculpture::Rgb;
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::history::SurfaceKind;
use crate::sculpture::orientation::Up;

pub static SPEC: FormatSpec = FormatSpec {
    write: Some(Export::Model(qb_write::write)),
    exported_as: Some("Qubicle"),
    ..FormatSpec::new(
        "a Qubicle model",
        &["qb"],
        Import::Model(ModelReader {
            read: |file| Ok(Box::new(read(file)?)),
            surface: SurfaceKind::Cubes,
        }),
    )
};

/// A file.
#[derive(Debug)]
struct Qb<'a> {
    is_bgra: bool,
    /// Whether x points the other way: a model that faces forward along z faces the viewer in either case.
    is_left_handed: bool,
    is_packed: bool,
    matrices: Vec<Matrix<'a>>,
}

#[derive(Debug)]
struct Matrix<'a> {
    size: I64Vec3,
    place: I64Vec3,
    voxels: Bytes<'a>,
}

/// Reads the structure of a file.
fn read(file: &[u8]) -> Result<Qb<'_>, FormatError> {
    let mut bytes = Bytes::new(file);
    // Any version: they do not differ.
    bytes.u32()?;
    let start = bytes;
    let flags = [bytes.u32()?, bytes.u32()?, bytes.u32()?, bytes.u32()?];
    if flags.iter().any(|&flag| flag > 1) {
        return Err(start.fault("this is not a Qubicle file: its four flags are not 0 or 1"));
    }
    // The last flag makes opacity a mask of visible faces, which is 0 too where there is no voxel.
    let [is_bgra, is_right_handed, is_packed, _] = flags.map(|flag| flag == 1);
    let count = bytes.u32()?;
    let is_left_handed = !is_right_handed;
    let mut qb = Qb { is_bgra, is_left_handed, is_packed, matrices: Vec::new() };
    for _ in 0..count {
        let name_bytes = usize::from(bytes.u8()?);
        bytes.take(name_bytes)?;
        let start = bytes;
        let size = [bytes.u32()?, bytes.u32()?, bytes.u32()?];
        if size.iter().any(|&edge| edge == 0 || edge > MAX_AXIS_VX) {
            let [x, y, z] = size;
            let rule = format!("but an axis may have 1 to {MAX_AXIS_VX} voxels");
            return Err(start.fault(format!("a matrix of {x}x{y}x{z} voxels, {rule}")));
        }
        let size = I64Vec3::from_array(size.map(i64::from));
        let place = [bytes.i32()?, bytes.i32()?, bytes.i32()?].map(i64::from);
        let voxels = bytes;
        let matrix = Matrix { size, place: I64Vec3::from_array(place), voxels };
        bytes = match is_packed {
            true => matrix.runs(&mut |_, _, _| Ok(()))?,
            false => {
                bytes.take((size.element_product() * 4) as usize)?;
                bytes
            }
        };
        qb.matrices.push(matrix);
    }
    Ok(qb)
}

impl<'a> Matrix<'a> {
    /// Calls `f` with the index of the first voxel of each run, the run's length and colour. Returns the remaining
    /// bytes.
    fn runs(
        &self,
        f: &mut dyn FnMut(i64, i64, u32) -> Result<(), FormatError>,
    ) -> Result<Bytes<'a>, FormatError> {
        let slice = self.size.x * self.size.y;
        let mut bytes = self.voxels;
        for z in 0..self.size.z {
            let mut at = 0;
            loop {
                let start = bytes;
                let (count, colour) = match bytes.u32()? {
                    SLICE_END => break,
                    RUN => (i64::from(bytes.u32()?), bytes.u32()?),
                    colour => (1, colour),
                };
                if at + count > slice {
                    return Err(start.fault(format!("{count} voxels do not fit into slice {z}")));
                }
                f(z * slice + at, count, colour)?;
                at += count;
            }
        }
        Ok(bytes)
    }
}

impl Model for Qb<'_> {
    fn kind(&self) -> String {
        let packing = if self.is_packed { "packed" } else { "not packed" };
        format!("Qubicle, {packing}, matrices: {}", self.matrices.len())
    }

    fn up(&self) -> Up {
        Up::Y
    }

    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)> {
        let boxes = self.matrices.iter().map(|matrix| {
            let (low, high) = (matrix.place, matrix.place + matrix.size);
            match self.is_left_handed {
                true => (I64Vec3 { x: -high.x, ..low }, I64Vec3 { x: -low.x, ..high }),
                false => (low, high),
            }
        });
        boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError> {
        for matrix in &self.matrices {
            let (size, place) = (matrix.size, matrix.place);
            let mut put = |first: i64, count: i64, colour: u32| {
                let [a, b, c, opacity] = colour.to_le_bytes();
                if opacity == 0 {
                    return Ok(());
                }
                let rgb = Rgb(if self.is_bgra { [c, b, a] } else { [a, b, c] });
                for i in first..first + count {
                    let (x, y, z) = (i % size.x, i / size.x % size.y, i / (size.x * size.y));
                    let mut v = place + I64Vec3::new(x, y, z);
                    if self.is_left_handed {
                        v.x = -1 - v.x;
                    }
                    sink(v, rgb)?;
                }
                Ok(())
            };
            if self.is_packed {
                matrix.runs(&mut put)?;
            } else {
                let count = (size.element_product() * 4) as usize;
                let mut bytes = matrix.voxels;
                let (colours, _) = bytes.take(count)?.as_chunks();
                for (i, colour) in (0..).zip(colours) {
                    put(i, 1, u32::from_le_bytes(*colour))?;
                }
            }
        }
        Ok(())
    }
}

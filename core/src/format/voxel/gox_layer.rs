//! The layers of a Goxel file: their own blocks, copies of other layers (clones), or shapes that Goxel fills itself.
//!
//! Takes layers and a function that unpacks blocks; calls a sink for every voxel, in the axes of the file. Nested
//! copies are followed to a layer that is no copy; cycles terminate.

use glam::{DMat4, DVec3, I64Vec3};

use super::model::{Sink, upright};
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::sculpture::Rgb;

/// Edge of a block in voxels.
const EDGE_VX: i64 = 16;
/// Least opacity of existing voxels, as Goxel draws them.
const OPAQUE: u8 = 128;
/// Greatest number of nested copies that are followed.
const MOST_COPIES: usize = 64;
/// Greatest number of positions tested in a rotated block or a shape, for each layer.
const MOST_PLACES: f64 = (1u64 << 32) as f64;
/// Keeps positions on a border on the side where they are without rounding.
const ROUNDING: f64 = 1e-6;

#[derive(Debug, Default)]
pub struct GoxLayer {
    /// Number and lower corner of each of its blocks.
    pub placed: Vec<(usize, I64Vec3)>,
    pub is_hidden: bool,
    id: i32,
    /// The layer that this one copies, or 0.
    base: i32,
    /// The transform of a copy or a shape.
    matrix: DMat4,
    shape: Option<Shape>,
    colour: [u8; 4],
    /// The name of an unknown shape.
    pub unknown_shape: Option<String>,
}

/// A shape within -1 to 1 on all three axes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Shape {
    Sphere,
    Cube,
    /// Along z.
    Cylinder,
}

impl Shape {
    fn contains(self, v: DVec3) -> bool {
        let most = 1.0 + ROUNDING;
        match self {
            Shape::Sphere => v.length_squared() <= most,
            Shape::Cube => v.abs().max_element() <= most,
            Shape::Cylinder => v.truncate().length_squared() <= most && v.z.abs() <= most,
        }
    }
}

/// Reads the chunk of a layer.
pub fn read(mut chunk: Bytes<'_>) -> Result<GoxLayer, FormatError> {
    let mut layer = GoxLayer { matrix: DMat4::IDENTITY, colour: [255; 4], ..GoxLayer::default() };
    for _ in 0..chunk.count("blocks")? {
        let number = chunk.count("as the number of a block")?;
        let corner = [chunk.i32()?, chunk.i32()?, chunk.i32()?].map(i64::from);
        chunk.u32()?;
        layer.placed.push((number, I64Vec3::from_array(corner)));
    }
    // Names and values, ended by an empty name.
    while !chunk.is_empty() {
        let length = chunk.count("bytes")?;
        if length == 0 {
            break;
        }
        let name = chunk.take(length)?;
        let length = chunk.count("bytes")?;
        let mut value = chunk.part(length)?;
        match name {
            b"visible" => layer.is_hidden = value.rest().iter().all(|byte| *byte == 0),
            b"id" => layer.id = value.i32()?,
            b"base_id" => layer.base = value.i32()?,
            b"mat" => {
                let (numbers, _) = value.take(64)?.as_chunks();
                let numbers: Vec<f64> =
                    numbers.iter().map(|number| f32::from_le_bytes(*number).into()).collect();
                layer.matrix = DMat4::from_cols_slice(&numbers);
            }
            b"color" => layer.colour.copy_from_slice(value.take(4)?),
            b"shape" => match value.rest() {
                b"sphere" => layer.shape = Some(Shape::Sphere),
                b"cube" => layer.shape = Some(Shape::Cube),
                b"cylinder" => layer.shape = Some(Shape::Cylinder),
                other => layer.unknown_shape = Some(crate::format::error::excerpt(other)),
            },
            _ => {}
        }
    }
    Ok(layer)
}

/// Calls `sink` for the voxels of a layer; `decode` returns those of a block, x fastest, then y, then z.
pub fn walk(
    layer: &GoxLayer,
    all: &[GoxLayer],
    decode: &dyn Fn(usize) -> Result<Vec<[u8; 4]>, FormatError>,
    sink: &mut Sink<'_>,
) -> Result<(), FormatError> {
    let (mut own, mut matrix) = (layer, DMat4::IDENTITY);
    // A layer with its own blocks has them in place.
    let mut copies = 0;
    while own.placed.is_empty() && own.base != 0 {
        matrix *= own.matrix;
        copies += 1;
        let base = all.iter().find(|other| other.id == own.base);
        match base.filter(|_| copies <= MOST_COPIES) {
            Some(base) => own = base,
            None => return Ok(()),
        }
    }
    match own.shape {
        Some(shape) if own.placed.is_empty() => fill(shape, matrix * own.matrix, own.colour, sink),
        _ if copies == 0 => own.placed.iter().try_for_each(|(number, corner)| {
            for (i, voxel) in (0..).zip(decode(*number)?) {
                put(corner + place(i), voxel, sink)?;
            }
            Ok(())
        }),
        _ => {
            let mut places = 0.0;
            own.placed.iter().try_for_each(|(number, corner)| {
                turned(&decode(*number)?, *corner, matrix, &mut places, sink)
            })
        }
    }
}

/// Returns the position of voxel number `i` within a block.
fn place(i: i64) -> I64Vec3 {
    I64Vec3::new(i % EDGE_VX, i / EDGE_VX % EDGE_VX, i / EDGE_VX / EDGE_VX)
}

fn put(v: I64Vec3, [r, g, b, opacity]: [u8; 4], sink: &mut Sink<'_>) -> Result<(), FormatError> {
    if opacity >= OPAQUE { sink(upright(v), Rgb([r, g, b])) } else { Ok(()) }
}

/// Returns the voxel box around the image of a box under a matrix, with the inverse matrix.
fn around(
    matrix: DMat4,
    low: DVec3,
    high: DVec3,
    places: &mut f64,
) -> Result<Option<(I64Vec3, I64Vec3, DMat4)>, FormatError> {
    let back = matrix.inverse();
    if !back.is_finite() || !matrix.is_finite() {
        return Ok(None);
    }
    let corner = |i: usize| {
        let at = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
        matrix.transform_point3(DVec3::new(at(0), at(1), at(2)))
    };
    let least = (0..8).map(corner).fold(DVec3::INFINITY, DVec3::min).floor();
    let most = (0..8).map(corner).fold(DVec3::NEG_INFINITY, DVec3::max).ceil();
    *places += (most - least).element_product();
    let far = least.abs().max(most.abs()).max_element();
    if *places > MOST_PLACES || far > f64::from(i32::MAX) {
        return Err(FormatError::TooManyVoxels);
    }
    Ok(Some((least.as_i64vec3(), most.as_i64vec3(), back)))
}

/// Calls `f` for all positions from `low` to `high` (exclusive).
fn each(
    low: I64Vec3,
    high: I64Vec3,
    f: &mut dyn FnMut(I64Vec3) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    for z in low.z..high.z {
        for y in low.y..high.y {
            (low.x..high.x).try_for_each(|x| f(I64Vec3::new(x, y, z)))?;
        }
    }
    Ok(())
}

fn fill(
    shape: Shape,
    matrix: DMat4,
    colour: [u8; 4],
    sink: &mut Sink<'_>,
) -> Result<(), FormatError> {
    let Some((low, high, back)) = around(matrix, DVec3::NEG_ONE, DVec3::ONE, &mut 0.0)? else {
        return Ok(());
    };
    each(low, high, &mut |v| match shape.contains(back.transform_point3(v.as_dvec3() + 0.5)) {
        true => put(v, colour, sink),
        false => Ok(()),
    })
}

/// Transforms a block: each position that it may reach takes the voxel that is mapped to it.
fn turned(
    block: &[[u8; 4]],
    corner: I64Vec3,
    matrix: DMat4,
    places: &mut f64,
    sink: &mut Sink<'_>,
) -> Result<(), FormatError> {
    let low = corner.as_dvec3();
    let Some((least, most, back)) = around(matrix, low, low + EDGE_VX as f64, places)? else {
        return Ok(());
    };
    each(least, most, &mut |v| {
        let at = back.transform_point3(v.as_dvec3() + 0.5) + ROUNDING;
        let at = at.floor().as_i64vec3() - corner;
        if at.cmplt(I64Vec3::ZERO).any() || at.cmpge(I64Vec3::splat(EDGE_VX)).any() {
            return Ok(());
        }
        put(v, block[(at.x + EDGE_VX * (at.y + EDGE_VX * at.z)) as usize], sink)
    })
}

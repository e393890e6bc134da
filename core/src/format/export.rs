//! Converts a sculpture to a volume: existence as densities, RGBA, or packed colours.
//!
//! Works in slabs, in parallel. Colours of voxels that do not exist are lost. Knows no files.

use glam::UVec3;
use rayon::prelude::*;

use super::FormatError;
use super::options::ExportForm;
use super::signature::Signature;
use super::volume::{Samples, Texts, Volume};
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::colour::{pack8, pack16};
use crate::sculpture::history::Contents;
use crate::sculpture::{Brick, ColourDepth, Rgb};

/// Density or opacity of an existing voxel; others have 0, so that any threshold separates them.
const FULL: u8 = 255;

/// Converts a sculpture to a volume with `texts`, to which the program's signature is added.
pub(crate) fn to_volume(
    contents: &Contents,
    form: ExportForm,
    mut texts: Texts,
) -> Result<Volume, FormatError> {
    let (grid, material) = (&contents.grid, &contents.material);
    let depth = material.depth();
    let form = match (form, depth) {
        (ExportForm::Auto, ColourDepth::None) => ExportForm::Densities,
        (ExportForm::Auto, _) => ExportForm::Rgba,
        (ExportForm::Packed, ColourDepth::None) => return Err(FormatError::NoColours),
        (chosen, _) => chosen,
    };
    let (samples, colour_depth) = match (form, depth) {
        (ExportForm::Rgba, _) => (Samples::Rgba8, depth),
        (ExportForm::Packed, ColourDepth::Bits8) => (Samples::U8, depth),
        (ExportForm::Packed, ColourDepth::Bits16) => (Samples::U16Be, depth),
        (ExportForm::Packed, _) => (Samples::Rgb8, depth),
        (ExportForm::Densities | ExportForm::Auto, _) => (Samples::U8, ColourDepth::None),
    };
    super::pvm::check_size(grid.dims(), samples)?;
    Signature { form, colour_depth, base: material.base() }.put(&mut texts);
    let data = match (form, depth) {
        (ExportForm::Rgba, _) => colours(contents, |Rgb([r, g, b])| [r, g, b, FULL]),
        (ExportForm::Packed, ColourDepth::Bits8) => colours(contents, |c| [packed8(c)]),
        (ExportForm::Packed, ColourDepth::Bits16) => {
            colours(contents, |c| packed16(c).to_be_bytes())
        }
        (ExportForm::Packed, _) => colours(contents, packed24),
        (ExportForm::Densities | ExportForm::Auto, _) => densities(contents),
    };
    Ok(Volume { dims: grid.dims(), voxel_size: grid.voxel_size(), samples, data, texts })
}

/// Returns the packed colour of an existing voxel, which is never 0: black becomes the darkest other colour, which is a
/// green at 8 and 16 bits, where green has the finest steps.
fn packed8(colour: Rgb) -> u8 {
    match pack8(colour) {
        0 => 0x10,
        packed => packed,
    }
}

fn packed16(colour: Rgb) -> u16 {
    match pack16(colour) {
        0 => 0x0200,
        packed => packed,
    }
}

fn packed24(Rgb(colour): Rgb) -> [u8; 3] {
    if colour == [0; 3] { [0, 0, 1] } else { colour }
}

fn densities(contents: &Contents) -> Vec<u8> {
    voxels_by_brick(contents, |slab: &mut BrickLayer<1>, corner, brick| {
        let rows = brick.to_rows();
        let room = slab.room(corner);
        for z in 0..room.z {
            for y in 0..room.y {
                let bits = (rows[z as usize] >> (8 * y)) as u8;
                let bytes = spread_bits(bits).to_le_bytes();
                let start = slab.index(corner.x, corner.y + y, z);
                let row = &mut slab.voxels[start..start + room.x as usize];
                row.iter_mut().zip(bytes).for_each(|(voxel, byte)| *voxel = [byte]);
            }
        }
    })
}

/// Expands eight bits to eight bytes of 0 or 255, the lowest bit first in little-endian order.
fn spread_bits(bits: u8) -> u64 {
    let each = (u64::from(bits) * 0x0101_0101_0101_0101) & 0x8040_2010_0804_0201;
    // A byte with any bit set carries into its top bit, and none beyond.
    let top = (each + 0x7F7F_7F7F_7F7F_7F7F) & 0x8080_8080_8080_8080;
    (top >> 7) * u64::from(FULL)
}

fn colours<const B: usize>(contents: &Contents, of: impl Fn(Rgb) -> [u8; B] + Sync) -> Vec<u8> {
    let material = &contents.material;
    voxels_by_brick(contents, |slab: &mut BrickLayer<B>, corner, brick| {
        let page = material.page(corner / BRICK_EDGE_VX);
        brick.for_each(|local| {
            let [x, y, z] = local_coords(local);
            let at = slab.index(corner.x + x, corner.y + y, z);
            slab.voxels[at] = of(page.map_or(material.base(), |page| page.rgb(local)));
        });
    })
}

/// The voxels of one layer of bricks.
struct BrickLayer<'a, const B: usize> {
    voxels: &'a mut [[u8; B]],
    dims: UVec3,
}

impl<const B: usize> BrickLayer<'_, B> {
    /// Returns the index of a voxel, with `z` counted from the start of the slab.
    #[inline(always)]
    fn index(&self, x: u32, y: u32, z: u32) -> usize {
        x as usize + self.dims.x as usize * (y as usize + self.dims.y as usize * z as usize)
    }

    /// Returns the size of the part of a brick that lies in the grid.
    fn room(&self, corner: UVec3) -> UVec3 {
        (self.dims - corner).min(UVec3::splat(BRICK_EDGE_VX))
    }
}

/// Calls `write` for every non-empty brick with the slab to write to, the brick's lower corner, its bits and its linear
/// index.
fn voxels_by_brick<const B: usize>(
    contents: &Contents,
    write: impl Fn(&mut BrickLayer<B>, UVec3, &Brick) + Sync,
) -> Vec<u8> {
    let grid = &contents.grid;
    let dims = grid.dims();
    let slice = dims.x as usize * dims.y as usize;
    let mut voxels = vec![[0u8; B]; slice * dims.z as usize];
    let slabs = voxels.par_chunks_mut(slice * BRICK_EDGE_VX as usize);
    slabs.enumerate().for_each(|(bz, voxels)| {
        let mut slab = BrickLayer { voxels, dims };
        for by in 0..grid.brick_dims().y {
            for (bx, brick) in grid.nonempty_in_row(by, bz as u32) {
                let at = UVec3::new(bx, by, bz as u32);
                write(&mut slab, at * BRICK_EDGE_VX, brick);
            }
        }
    });
    voxels.into_flattened()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sculpture::colour::{unpack8, unpack16};

    #[test]
    fn black_becomes_the_nearest_colour_that_is_not_zero() {
        let distance = |Rgb(c): Rgb| c.iter().map(|&v| u32::from(v).pow(2)).sum::<u32>();
        let nearest8 = (1..=u8::MAX).min_by_key(|&v| distance(unpack8(v))).unwrap();
        let nearest16 = (1..=u16::MAX).min_by_key(|&v| distance(unpack16(v))).unwrap();
        let black = Rgb::new(0, 0, 0);
        assert_eq!((packed8(black), packed16(black)), (nearest8, nearest16));
        assert_eq!(distance(Rgb(packed24(black))), 1);
        assert!((1..=u8::MAX).all(|v| packed8(unpack8(v)) == v));
    }

    #[test]
    fn bits_spread_to_bytes() {
        for bits in 0..=u8::MAX {
            let expected = std::array::from_fn(|i| if bits >> i & 1 != 0 { 255 } else { 0 });
            assert_eq!(spread_bits(bits).to_le_bytes(), expected);
        }
    }
}

//! Writes MagicaVoxel's `.vox`: a palette of 255 colours, and models of at most 256 voxels per axis, which a scene
//! reassembles.
//!
//! The voxels are streamed brick by brick; nothing of their size is kept in memory. Reading restores the same grid, and
//! the same colours if the sculpture has no more than 255.

use std::io::{self, Write};

use glam::UVec3;

use super::quantise::{Palette, palette};
use crate::format::{FormatError, go_on};
use crate::progress::Progress;
use crate::sculpture::Grid;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::history::Contents;

/// The start of a file.
pub const MAGIC: &[u8] = b"VOX ";
/// Greatest edge of a model.
pub const MAX_EDGE_VX: u32 = 256;
/// Number of colours of a palette.
const COLOURS: usize = 255;
/// The version that all programs read.
const VERSION: u32 = 150;

/// A part of the grid that becomes a model.
struct VoxBlock {
    low: UVec3,
    size: UVec3,
    voxels: u64,
}

/// Writes a sculpture. Fails before the first byte if it is too large. Returns notes on what it cannot store.
pub fn write(
    contents: &Contents,
    out: &mut dyn Write,
    progress: &dyn Progress,
) -> Result<Vec<String>, FormatError> {
    let grid = &contents.grid;
    progress.begin("finding the palette");
    let palette = palette(contents, COLOURS);
    progress.end();
    go_on(progress)?;
    let mut notes = Vec::new();
    let (there_were, kept) = (palette.stands_for(), palette.colours.len());
    if kept < there_were {
        notes.push(format!(
            "{there_were} colours were reduced to the {kept} that .vox has room for"
        ));
    }
    let blocks = blocks(grid);
    let scene = if blocks.len() > 1 { scene(&blocks, grid.dims()) } else { Vec::new() };
    let model_bytes = |block: &VoxBlock| 24 + 16 + 4 * block.voxels;
    let palette_bytes = 12 + 1024;
    let children = blocks.iter().map(model_bytes).sum::<u64>() + scene.len() as u64 + palette_bytes;
    let children = i32::try_from(children).map_err(|_| FormatError::TooLargeForVox)?;
    out.write_all(MAGIC)?;
    out.write_all(&VERSION.to_le_bytes())?;
    out.write_all(b"MAIN")?;
    words(out, &[0, children])?;
    progress.begin("writing");
    for (i, block) in blocks.iter().enumerate() {
        go_on(progress)?;
        progress.advance(i as f32 / blocks.len() as f32);
        write_block(contents, &palette, block, out)?;
    }
    progress.end();
    out.write_all(&scene)?;
    out.write_all(b"RGBA")?;
    words(out, &[1024, 0])?;
    for i in 0..256 {
        let [r, g, b] = palette.colours.get(i).copied().unwrap_or_default().0;
        out.write_all(&[r, g, b, 255])?;
    }
    Ok(notes)
}

fn words(out: &mut dyn Write, words: &[i32]) -> io::Result<()> {
    words.iter().try_for_each(|word| out.write_all(&word.to_le_bytes()))
}

/// Returns the blocks that hold voxels, and those at the lowest and the highest corner, which keep the size of the
/// grid.
fn blocks(grid: &Grid) -> Vec<VoxBlock> {
    let dims = grid.dims();
    let count = dims.map(|edge| edge.div_ceil(MAX_EDGE_VX));
    let bricks_per_block = MAX_EDGE_VX / BRICK_EDGE_VX;
    let index = |block: UVec3| (block.x + count.x * (block.y + count.y * block.z)) as usize;
    let mut voxels = vec![0; count.element_product() as usize];
    for (at, brick) in grid.nonempty_bricks() {
        voxels[index(at / bricks_per_block)] += u64::from(brick.count());
    }
    let last = voxels.len() - 1;
    let all = voxels.into_iter().enumerate();
    all.filter(|(i, voxels)| *voxels > 0 || *i == 0 || *i == last)
        .map(|(i, voxels)| {
            let i = i as u32;
            let block = UVec3::new(i % count.x, i / count.x % count.y, i / (count.x * count.y));
            let low = block * MAX_EDGE_VX;
            VoxBlock { low, size: (dims - low).min(UVec3::splat(MAX_EDGE_VX)), voxels }
        })
        .collect()
}

fn write_block(
    contents: &Contents,
    palette: &Palette,
    block: &VoxBlock,
    out: &mut dyn Write,
) -> io::Result<()> {
    let (grid, material) = (&contents.grid, &contents.material);
    let UVec3 { x: width, y: height, z: depth } = block.size;
    out.write_all(b"SIZE")?;
    words(out, &[12, 0, width as i32, depth as i32, height as i32])?;
    let voxels = block.voxels as i32;
    out.write_all(b"XYZI")?;
    words(out, &[4 + 4 * voxels, 0, voxels])?;
    let (first, end) = (block.low / BRICK_EDGE_VX, (block.low + block.size).map(|v| v.div_ceil(8)));
    let mut bytes = Vec::new();
    for (y, z) in (first.z..end.z).flat_map(|z| (first.y..end.y).map(move |y| (y, z))) {
        bytes.clear();
        let row = grid.nonempty_in_row(y, z).filter(|(x, _)| (first.x..end.x).contains(x));
        for (x, brick) in row {
            let at = UVec3::new(x, y, z);
            let (page, corner) = (material.page(at), at * BRICK_EDGE_VX - block.low);
            brick.for_each(|local| {
                let v = corner + UVec3::from(local_coords(local));
                let colour =
                    palette.index(page.map_or(material.base(), |page| page.rgb(local))) + 1;
                bytes.extend([v.x as u8, (depth - 1 - v.z) as u8, v.y as u8, colour]);
            });
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Returns the chunks that place the blocks, as models in their order: around the origin, on the ground.
fn scene(blocks: &[VoxBlock], dims: UVec3) -> Vec<u8> {
    let mut scene = Vec::new();
    let mut chunk = |id: &[u8; 4], content: &[u8]| {
        scene.extend_from_slice(id);
        scene.extend_from_slice(&(content.len() as i32).to_le_bytes());
        scene.extend_from_slice(&0i32.to_le_bytes());
        scene.extend_from_slice(content);
    };
    let bytes = |words: &[i32]| words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    // Node, texts, child, reserved, layer, frames, texts of the frame.
    chunk(b"nTRN", &bytes(&[0, 0, 1, -1, -1, 1, 0]));
    let count = blocks.len() as i32;
    let mut group = bytes(&[1, 0, count]);
    group.extend(bytes(&(0..count).map(|i| 2 + 2 * i).collect::<Vec<i32>>()));
    chunk(b"nGRP", &group);
    for (i, block) in (0..).zip(blocks) {
        let (size, low) = (block.size.as_ivec3(), block.low.as_ivec3());
        let back = dims.z as i32 - (low.z + size.z);
        let shift = format!(
            "{} {} {}",
            low.x + size.x / 2 - dims.x as i32 / 2,
            back + size.z / 2 - dims.z as i32 / 2,
            low.y + size.y / 2
        );
        let mut transform = bytes(&[2 + 2 * i, 0, 3 + 2 * i, -1, 0, 1, 1, 2]);
        transform.extend_from_slice(b"_t");
        transform.extend(bytes(&[shift.len() as i32]));
        transform.extend_from_slice(shift.as_bytes());
        chunk(b"nTRN", &transform);
        // Node, texts, models, the model and its texts.
        chunk(b"nSHP", &bytes(&[3 + 2 * i, 0, 1, i, 0]));
    }
    scene
}

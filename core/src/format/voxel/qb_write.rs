//! Writes Qubicle's `.qb`: one matrix of any size with colours of 24 bits, packed as runs.

use std::io::Write;

use glam::UVec3;

use crate::format::{FormatError, go_on};
use crate::progress::Progress;
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords};
use crate::sculpture::history::Contents;

/// Words in the voxels of a matrix that are no colours: the start of a run, and the end of a slice.
pub const RUN: u32 = 2;
pub const SLICE_END: u32 = 6;
/// Major, minor, release and build number of the format.
const VERSION: [u8; 4] = [1, 1, 0, 0];
const NAME: &[u8] = b"sculpture";

/// Writes a sculpture, slice by slice.
pub fn write(
    contents: &Contents,
    out: &mut dyn Write,
    progress: &dyn Progress,
) -> Result<Vec<String>, FormatError> {
    let dims = contents.grid.dims();
    out.write_all(&VERSION)?;
    // RGBA, right-handed, packed, opacity as it is; one matrix.
    word_by_word(out, &[0, 1, 1, 0, 1])?;
    out.write_all(&[NAME.len() as u8])?;
    out.write_all(NAME)?;
    word_by_word(out, &[dims.x, dims.y, dims.z, 0, 0, 0])?;
    let slice = dims.x as usize * dims.y as usize;
    let mut slab = vec![0u32; slice * BRICK_EDGE_VX as usize];
    let layers = dims.z.div_ceil(BRICK_EDGE_VX);
    progress.begin("writing");
    for layer in 0..layers {
        go_on(progress)?;
        progress.advance(layer as f32 / layers as f32);
        slab.fill(0);
        fill(contents, layer, &mut slab);
        let slices = (dims.z - layer * BRICK_EDGE_VX).min(BRICK_EDGE_VX) as usize;
        for voxels in slab.chunks_exact(slice).take(slices) {
            let mut packed = Vec::new();
            for run in voxels.chunk_by(|a, b| a == b) {
                match run.len() {
                    1 => packed.push(run[0]),
                    length => packed.extend([RUN, length as u32, run[0]]),
                }
            }
            packed.push(SLICE_END);
            word_by_word(out, &packed)?;
        }
    }
    progress.end();
    Ok(Vec::new())
}

fn word_by_word(out: &mut dyn Write, words: &[u32]) -> std::io::Result<()> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    out.write_all(&bytes)
}

/// Writes the voxels of a layer of bricks: opaque colours, which differ from the reserved words, or 0.
fn fill(contents: &Contents, layer: u32, slab: &mut [u32]) {
    let (grid, material) = (&contents.grid, &contents.material);
    let UVec3 { x: width, y: height, .. } = grid.dims();
    for by in 0..grid.brick_dims().y {
        for (bx, brick) in grid.nonempty_in_row(by, layer) {
            let page = material.page(UVec3::new(bx, by, layer));
            brick.for_each(|local| {
                let [x, y, z] = local_coords(local);
                let at = bx * BRICK_EDGE_VX + x + width * (by * BRICK_EDGE_VX + y);
                let [r, g, b] = page.map_or(material.base(), |page| page.rgb(local)).0;
                let place = at as usize + width as usize * height as usize * z as usize;
                slab[place] = u32::from_le_bytes([r, g, b, 255]);
            });
        }
    }
}

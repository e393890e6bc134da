//! Finds rectangles of faces in the planes of the voxel lattice, row by row: a run of faces is extended to the rows
//! that contain all of it (Lysenko, "Meshing in a Minecraft game", 2012), with masks of 64 faces at a time.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use crate::mesh::rows::{VoxelRows, for_each_bit, moved_up, row_words};
use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::history::Contents;

/// Merged faces of a plane: those between `low` and `high`, corners of the lattice that differ along two axes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Rectangle {
    /// The axis that it is perpendicular to.
    pub axis: u8,
    /// Whether it faces up.
    pub is_up: bool,
    /// Its lowest corner.
    pub low: [u16; 3],
    /// Its highest corner.
    pub high: [u16; 3],
}

/// Planes that are processed together: those of a word.
pub const PLANES: u32 = 64;

/// Returns the rectangles of all planes across `axis`, in portions. `is_coloured`: faces of different colours are not
/// merged. `goes_on` gets the number of rectangles found in a portion; once it returns false, the rest is left out.
pub fn rectangles(
    contents: &Contents,
    axis: usize,
    is_coloured: bool,
    goes_on: impl Fn(usize) -> bool + Sync,
) -> Vec<Vec<Rectangle>> {
    let end = contents.grid.dims()[axis] + 1;
    let starts: Vec<u32> = (0..end).step_by(PLANES as usize).collect();
    let stopped = AtomicBool::new(false);
    let portion = |&start: &u32| {
        if stopped.load(Ordering::Relaxed) {
            return Vec::new();
        }
        let found = of_planes(contents, axis, start..(start + PLANES).min(end), is_coloured);
        if !goes_on(found.len()) {
            stopped.store(true, Ordering::Relaxed);
        }
        found
    };
    starts.par_iter().map(portion).collect()
}

/// The faces of some planes in one direction: a bit for each, in rows along `along`.
struct Faces {
    axis: usize,
    is_up: bool,
    /// The axis of the rows, and that from row to row.
    along: usize,
    across: usize,
    first_plane: u32,
    /// Words of a row, rows of a plane.
    width: usize,
    height: usize,
    bits: Vec<u64>,
}

fn of_planes(
    contents: &Contents,
    axis: usize,
    planes: std::ops::Range<u32>,
    is_coloured: bool,
) -> Vec<Rectangle> {
    let grid = &contents.grid;
    let dims = grid.dims();
    // Rows along x if possible.
    let (along, across) = [(1, 2), (0, 2), (0, 1)][axis];
    let (width, height) = (dims[along].div_ceil(64) as usize, dims[across] as usize);
    let words = width * height * planes.len();
    let empty = |is_up| Faces {
        axis,
        is_up,
        along,
        across,
        first_plane: planes.start,
        width,
        height,
        bits: vec![0; words],
    };
    let mut faces = [empty(true), empty(false)];
    fill(grid, &planes, &mut faces);
    let mut found = Vec::new();
    for mut faces in faces {
        for plane in planes.clone() {
            if is_coloured {
                faces.split_off_colours(contents, plane, &mut found);
            }
            faces.merge(plane, &mut found);
        }
    }
    found
}

/// Sets the faces of `planes`, up and down.
fn fill(grid: &Grid, planes: &std::ops::Range<u32>, faces: &mut [Faces; 2]) {
    let dims = grid.dims();
    let words = row_words(dims);
    let (first, end) = (i64::from(planes.start), i64::from(planes.end));
    // Layers of voxels, or of pairs of them.
    let layers = if faces[0].axis == 2 { first..end } else { 0..i64::from(dims.z) };
    const THICKNESS: i64 = 16;
    for start in layers.clone().step_by(THICKNESS as usize) {
        let part = start..(start + THICKNESS).min(layers.end);
        let rows = VoxelRows::of(grid, part.start - 1..part.end);
        for z in part {
            match faces[0].axis {
                0 => {
                    let word = planes.start as usize / 64;
                    for y in 0..dims.y {
                        let row = rows.row(y.into(), z);
                        let (here, left) = (row[word], moved_up(row, word));
                        for (faces, bits) in faces.iter_mut().zip([left & !here, here & !left]) {
                            for_each_bit(bits, |plane| faces.set(plane, y as usize, z as usize));
                        }
                    }
                }
                1 => {
                    for y in first..end {
                        let (here, before) = (rows.row(y, z), rows.row(y - 1, z));
                        for i in 0..words.min(faces[0].width) {
                            let at = faces[0].word((y - first) as usize, z as usize, i);
                            faces[0].bits[at] = before[i] & !here[i];
                            faces[1].bits[at] = here[i] & !before[i];
                        }
                    }
                }
                _ => {
                    for y in 0..i64::from(dims.y) {
                        let (here, below) = (rows.row(y, z), rows.row(y, z - 1));
                        for i in 0..words.min(faces[0].width) {
                            let at = faces[0].word((z - first) as usize, y as usize, i);
                            faces[0].bits[at] = below[i] & !here[i];
                            faces[1].bits[at] = here[i] & !below[i];
                        }
                    }
                }
            }
        }
    }
}

impl Faces {
    #[inline(always)]
    fn word(&self, plane: usize, row: usize, word: usize) -> usize {
        (plane * self.height + row) * self.width + word
    }

    #[inline(always)]
    fn set(&mut self, plane: usize, at: usize, row: usize) {
        let word = self.word(plane, row, at / 64);
        self.bits[word] |= 1 << (at % 64);
    }

    fn rectangle(&self, plane: u32, [from, to]: [usize; 2], [first, end]: [usize; 2]) -> Rectangle {
        let (mut low, mut high) = ([plane as u16; 3], [plane as u16; 3]);
        (low[self.along], high[self.along]) = (from as u16, to as u16);
        (low[self.across], high[self.across]) = (first as u16, end as u16);
        Rectangle { axis: self.axis as u8, is_up: self.is_up, low, high }
    }

    /// Removes the faces with another colour nearby, each as a rectangle of its own.
    fn split_off_colours(&mut self, contents: &Contents, plane: u32, found: &mut Vec<Rectangle>) {
        let number = (plane - self.first_plane) as usize;
        for row in 0..self.height {
            for i in 0..self.width {
                let word = self.word(number, row, i);
                for_each_bit(self.bits[word], |bit| {
                    let at = 64 * i + bit;
                    let mut voxel = IVec3::ZERO;
                    voxel[self.axis] = plane as i32 - i32::from(self.is_up);
                    voxel[self.along] = at as i32;
                    voxel[self.across] = row as i32;
                    if !has_one_colour(contents, voxel) {
                        self.bits[word] &= !(1 << bit);
                        found.push(self.rectangle(plane, [at, at + 1], [row, row + 1]));
                    }
                });
            }
        }
    }

    /// Merges the faces of a plane, and removes them.
    fn merge(&mut self, plane: u32, found: &mut Vec<Rectangle>) {
        let number = (plane - self.first_plane) as usize;
        for row in 0..self.height {
            let mut i = 0;
            while i < self.width {
                let bits = self.bits[self.word(number, row, i)];
                if bits == 0 {
                    i += 1;
                    continue;
                }
                let from = 64 * i + bits.trailing_zeros() as usize;
                let to = self.run_end(number, row, from);
                self.clear(number, row, from, to);
                let mut end = row + 1;
                while end < self.height && self.has_all(number, end, from, to) {
                    self.clear(number, end, from, to);
                    end += 1;
                }
                found.push(self.rectangle(plane, [from, to], [row, end]));
            }
        }
    }

    /// Returns the end of the run of faces that starts at `from`.
    fn run_end(&self, plane: usize, row: usize, from: usize) -> usize {
        let mut at = from;
        loop {
            let bits = self.bits[self.word(plane, row, at / 64)] >> (at % 64);
            let ones = bits.trailing_ones() as usize;
            at += ones;
            if ones == 0 || !at.is_multiple_of(64) || at / 64 >= self.width {
                return at;
            }
        }
    }

    fn has_all(&self, plane: usize, row: usize, from: usize, to: usize) -> bool {
        masks(from, to).all(|(i, mask)| self.bits[self.word(plane, row, i)] & mask == mask)
    }

    fn clear(&mut self, plane: usize, row: usize, from: usize, to: usize) {
        for (i, mask) in masks(from, to) {
            let word = self.word(plane, row, i);
            self.bits[word] &= !mask;
        }
    }
}

/// Returns the words of the bits from `from` to before `to`, with their masks.
fn masks(from: usize, to: usize) -> impl Iterator<Item = (usize, u64)> {
    (from / 64..to.div_ceil(64)).map(move |i| {
        let low = from.saturating_sub(64 * i).min(64);
        let high = (to - 64 * i).min(64);
        (i, u64::MAX << low & u64::MAX >> (64 - high))
    })
}

/// Returns whether the existing voxels at and around `voxel` have the same colour.
fn has_one_colour(contents: &Contents, voxel: IVec3) -> bool {
    let (grid, material) = (&contents.grid, &contents.material);
    let last = grid.dims().as_ivec3() - 1;
    let low = (voxel - 1).clamp(IVec3::ZERO, last).as_uvec3();
    let high = (voxel + 1).clamp(IVec3::ZERO, last).as_uvec3();
    let (first, end) = (low / BRICK_EDGE_VX, high / BRICK_EDGE_VX);
    let is_painted = |b: UVec3| material.page(b).is_some();
    if !within(first, end).any(is_painted) {
        return true;
    }
    let own = contents.rgb(voxel.as_uvec3());
    within(low, high).all(|v| !grid.get(v.as_ivec3()) || contents.rgb(v) == own)
}

/// Returns all positions from `low` to `high`.
fn within(low: UVec3, high: UVec3) -> impl Iterator<Item = UVec3> {
    (low.z..=high.z).flat_map(move |z| {
        (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| UVec3::new(x, y, z)))
    })
}

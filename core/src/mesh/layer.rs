//! The vertices of one layer of the lattice of voxel corners, and their indices.
//!
//! A layer indexes its vertices: first one for each corner of the surface, row by row; then the further fans of corners
//! that have several, and the vertices in the middle of pinched edges along x and y; then those of pinched edges along
//! z. An edge is *pinched* if four faces meet in it and neither of its corners separates their two pairs: without
//! vertices of its own, one for each pair, four faces would share one edge of the mesh.
//!
//! Takes rows of bits; knows no positions.

use super::contact::{CORNERS, Corner, odd_corners};
use super::rows::{BitPlaces, VoxelRows, columns, for_each_bit, moved_down, moved_up};

/// The number of slots of a corner in the keys of further vertices: fans 1 to 3, then two for the edge along each axis.
const PLACES: u32 = 16;
/// The slot of the vertices in the edge along x.
const EDGE_PLACE: u32 = 4;

/// The vertices of the lattice's layer between the voxel layers `z - 1` and `z`.
#[derive(Default)]
pub struct VertexLayer {
    /// Words in a row of corners.
    pub width: usize,
    /// Corners of the surface, a bit each.
    pub corners: Vec<u64>,
    /// Corners with several fans or at the lower end of a pinched edge.
    pub odd: Vec<u64>,
    /// Corners with several fans or at either end of an edge that may be pinched.
    pub ambiguous: Vec<u64>,
    /// Rank of the first corner of each row, and the number of corners.
    row_starts: Vec<u32>,
    /// The position of each corner along x, by rank.
    places: Vec<u16>,
    /// The octants of each corner, by rank.
    octants: Vec<u8>,
    /// Keys of the further vertices, in ascending order; those of pinched edges along z separately.
    further: Vec<u32>,
    further_z: Vec<u32>,
    has_odd: bool,
}

/// The buffers for a row of corners while a layer is read.
pub struct RowOfCorners {
    places: BitPlaces,
    /// By position along x; unspecified where there is no corner.
    octants: Vec<u8>,
}

impl RowOfCorners {
    /// Returns buffers for rows of `width` words.
    pub fn new(width: usize) -> RowOfCorners {
        RowOfCorners { places: BitPlaces::new(width), octants: vec![0; 64 * width] }
    }
}

/// The kind of a vertex beyond the first of its corner.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Further {
    /// The fan of this index.
    Fan(usize),
    /// In the middle of the edge from the corner along an axis; on the side of the existing voxel with this bit along
    /// the second axis after it.
    Middle { axis: usize, side: usize },
}

impl VertexLayer {
    /// Returns the layer below the voxel layer `z`, without the pinched edges along z.
    pub fn new(rows: &VoxelRows, z: i64) -> VertexLayer {
        let mut layer = VertexLayer::default();
        layer.read(rows, z, &mut RowOfCorners::new(rows.width()));
        layer
    }

    /// Replaces the layer by [`VertexLayer::new`], in its existing memory.
    pub fn read(&mut self, rows: &VoxelRows, z: i64, row: &mut RowOfCorners) {
        let (width, height) = (rows.width(), rows.corner_rows);
        let layer = self;
        layer.width = width;
        for bits in [&mut layer.corners, &mut layer.odd] {
            bits.clear();
            bits.resize(width * height, 0);
        }
        for numbers in [&mut layer.row_starts, &mut layer.further, &mut layer.further_z] {
            numbers.clear();
        }
        layer.ambiguous.clear();
        layer.places.clear();
        layer.octants.clear();
        layer.has_odd = false;
        let RowOfCorners { places, octants } = row;
        for y in 0..height {
            layer.row_starts.push(layer.octants.len() as u32);
            places.clear();
            let [a, b] = [y as i64 - 1, y as i64];
            let around = [rows.row(a, z - 1), rows.row(b, z - 1), rows.row(a, z), rows.row(b, z)];
            for i in 0..width {
                // The row of each octant.
                let mut words = [0; 8];
                for (j, row) in around.iter().enumerate() {
                    (words[2 * j], words[2 * j + 1]) = (moved_up(row, i), row[i]);
                }
                let any = words.iter().fold(0, |all, bits| all | bits);
                let all = words.iter().fold(u64::MAX, |all, bits| all & bits);
                let corners = any & !all & rows.corner_mask[i];
                if corners == 0 {
                    continue;
                }
                let odd = odd_corners(&words) & corners;
                layer.corners[y * width + i] = corners;
                layer.odd[y * width + i] = odd;
                layer.has_odd |= odd != 0;
                places.add(i, corners);
                let octants = &mut octants[64 * i..64 * (i + 1)];
                for (byte, octants) in octants.as_chunks_mut::<8>().0.iter_mut().enumerate() {
                    if corners >> (8 * byte) & 0xFF != 0 {
                        *octants = columns(&words, byte);
                    }
                }
            }
            let places = places.of_row();
            layer.places.extend_from_slice(places);
            layer.octants.extend(places.iter().map(|&x| octants[usize::from(x)]));
        }
        layer.row_starts.push(layer.octants.len() as u32);
        if layer.has_odd {
            layer.ambiguous.extend_from_slice(&layer.odd);
            layer.find_further();
        }
    }

    /// Lists the further vertices of the layer's own corners and of its edges along x and y.
    fn find_further(&mut self) {
        for y in 0..self.height() {
            for i in 0..self.width {
                let odd = self.odd[y * self.width + i];
                let mut kept = 0;
                for_each_bit(odd, |bit| {
                    let x = 64 * i + bit;
                    let Some(corner) = self.corner(x, y) else { return };
                    let key = self.key(x, y);
                    let before = self.further.len();
                    self.further.extend((1..u32::from(corner.count)).map(|fan| key + fan));
                    for (axis, end) in [(0, self.corner(x + 1, y)), (1, self.corner(x, y + 1))] {
                        if is_pinched(Some(corner), end, axis) {
                            let first = key + EDGE_PLACE + 2 * axis as u32;
                            self.further.extend([first, first + 1]);
                        }
                    }
                    // An edge along z may still be pinched.
                    let may_be = corner.pinched[2] & 2 != 0;
                    kept |= u64::from(may_be || self.further.len() > before) << bit;
                });
                self.odd[y * self.width + i] = kept;
            }
        }
    }

    /// Lists the pinched edges from this layer to the layer above.
    pub(crate) fn find_edges_to(&mut self, above: &VertexLayer) {
        if !self.has_odd {
            return;
        }
        for y in 0..self.height() {
            for i in 0..self.width {
                for_each_bit(
                    self.odd[y * self.width + i] & above.corners[y * self.width + i],
                    |bit| {
                        let x = 64 * i + bit;
                        if is_pinched(self.corner(x, y), above.corner(x, y), 2) {
                            let first = self.key(x, y) + EDGE_PLACE + 4;
                            self.further_z.extend([first, first + 1]);
                        }
                    },
                );
            }
        }
    }

    /// Returns the bytes on the heap.
    pub fn heap_bytes(&self) -> u64 {
        let words = self.corners.capacity() + self.odd.capacity() + self.ambiguous.capacity();
        let numbers =
            self.row_starts.capacity() + self.further.capacity() + self.further_z.capacity();
        (8 * words + 4 * numbers + 2 * self.places.capacity() + self.octants.capacity()) as u64
    }

    /// Returns the number of corners, the first vertices.
    pub(crate) fn corner_count(&self) -> usize {
        self.octants.len()
    }

    /// Returns the number of vertices.
    pub fn count(&self) -> usize {
        self.octants.len() + self.further.len() + self.further_z.len()
    }

    /// Returns whether each vertex is the first of its corner and no edge of the layer is pinched.
    pub(crate) fn is_plain(&self) -> bool {
        !self.has_odd
    }

    fn key(&self, x: usize, y: usize) -> u32 {
        (x + y * (64 * self.width)) as u32 * PLACES
    }

    /// Returns the rank of the corner at (x, y), which must belong to the surface.
    fn rank(&self, x: usize, y: usize) -> usize {
        let row = &self.corners[y * self.width..];
        let before: u32 = row[..x / 64].iter().map(|word| word.count_ones()).sum();
        let last = (row[x / 64] & ((1 << (x % 64)) - 1)).count_ones();
        (self.row_starts[y] + before + last) as usize
    }

    /// Returns whether the lattice has corners at y.
    pub(crate) fn has_row(&self, y: usize) -> bool {
        y < self.height()
    }

    /// Returns the rows of corners.
    fn height(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// Returns the octants of the corner at (x, y), which must belong to the surface.
    pub(crate) fn octants_at(&self, x: usize, y: usize) -> u8 {
        self.octants[self.rank(x, y)]
    }

    /// Returns the corner at (x, y), if the surface passes through it.
    pub fn corner(&self, x: usize, y: usize) -> Option<&'static Corner> {
        let word = (self.has_row(y) && x / 64 < self.width)
            .then(|| self.corners[y * self.width + x / 64])?;
        (word >> (x % 64) & 1 != 0).then(|| &CORNERS[self.octants[self.rank(x, y)] as usize])
    }

    /// Returns the index in the layer of the vertex of a fan of the corner at (x, y), which must belong to the surface.
    pub fn fan(&self, x: usize, y: usize, fan: usize) -> usize {
        match fan {
            0 => self.rank(x, y),
            _ => self.find(&self.further, self.key(x, y) + fan as u32, self.octants.len()),
        }
    }

    /// Returns the index of the vertex in the edge from (x, y) along `axis`, on the side of the existing voxel with
    /// this bit along the second axis after it. `None` if the edge is not pinched.
    pub fn middle(&self, x: usize, y: usize, axis: usize, side: usize) -> Option<usize> {
        let key = self.key(x, y) + EDGE_PLACE + 2 * axis as u32 + side as u32;
        let (keys, before) = match axis {
            2 => (&self.further_z, self.octants.len() + self.further.len()),
            _ => (&self.further, self.octants.len()),
        };
        keys.binary_search(&key).ok().map(|at| before + at)
    }

    fn find(&self, keys: &[u32], key: u32, before: usize) -> usize {
        before + keys.partition_point(|&other| other < key)
    }

    /// Returns the further vertices in the order of their indices: their corner and kind.
    pub fn further(&self) -> impl Iterator<Item = ([usize; 2], Further)> {
        self.further.iter().chain(&self.further_z).map(|&key| {
            let (at, place) = ((key / PLACES) as usize, (key % PLACES) as usize);
            let row = 64 * self.width;
            let further = match place.checked_sub(EDGE_PLACE as usize) {
                None => Further::Fan(place),
                Some(edge) => Further::Middle { axis: edge / 2, side: edge % 2 },
            };
            ([at % row, at / row], further)
        })
    }

    /// Returns the keys of the further vertices, in the order of their indices: the corner, and the slot of the vertex.
    pub fn further_keys(&self) -> impl Iterator<Item = ([usize; 2], u8)> {
        let row = 64 * self.width;
        self.further.iter().chain(&self.further_z).map(move |&key| {
            let at = (key / PLACES) as usize;
            ([at % row, at / row], (key % PLACES) as u8)
        })
    }

    /// Returns the corners by rows, in the order of their indices: y, the positions along x, and the octants of each.
    pub fn rows(&self) -> impl Iterator<Item = (usize, &[u16], &[u8])> {
        (0..self.height()).map(|y| {
            let row = self.row_starts[y] as usize..self.row_starts[y + 1] as usize;
            (y, &self.places[row.clone()], &self.octants[row])
        })
    }

    /// Writes the indices of the corners of row `y` to their positions in `numbers`, starting at `base`.
    #[inline(always)]
    pub(crate) fn number_row(&self, y: usize, base: u32, numbers: &mut [u32]) {
        let (first, end) = (self.row_starts[y], self.row_starts[y + 1]);
        let places = &self.places[first as usize..end as usize];
        for (&place, number) in places.iter().zip(base + first..) {
            numbers[usize::from(place)] = number;
        }
    }

    /// Returns whether a row has no odd corner.
    pub(crate) fn is_plain_row(&self, y: usize) -> bool {
        self.odd_row(y).iter().all(|&word| word == 0)
    }

    fn odd_row(&self, y: usize) -> &[u64] {
        &self.odd[y * self.width..(y + 1) * self.width]
    }

    /// Returns whether the corner at (x, y) is odd.
    pub(crate) fn is_odd(&self, x: u16, y: usize) -> bool {
        self.odd[y * self.width + usize::from(x) / 64] >> (x % 64) & 1 != 0
    }

    /// Returns the positions of row `y` whose corner, or the next one, is odd, as bits.
    pub(crate) fn odd_beside(&self, y: usize, i: usize) -> u64 {
        let row = self.odd_row(y);
        row[i] | moved_down(row, i)
    }
}

/// Returns whether an edge between two corners has four faces, in two pairs that neither of them separates.
fn is_pinched(low: Option<&Corner>, high: Option<&Corner>, axis: usize) -> bool {
    let (Some(low), Some(high)) = (low, high) else { return false };
    low.pinched[axis] & 2 != 0 && high.pinched[axis] & 1 != 0
}

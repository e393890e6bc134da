//! The part of a mesh in some layers of the lattice, with a face for each exposed face of a voxel.
//!
//! Takes the contents, the placement of vertices, and a range of layers; returns a [`MeshPart`] that owns the vertices of
//! these layers. Its faces also refer to vertices of the next layer, with which the next part begins: their indices
//! continue its own, so parts that were made independently fit together.

use std::ops::Range;

use glam::{IVec3, Vec3};

use super::layer::{Further, RowOfCorners, VertexLayer};
use super::place::{VertexPlacement, colour, octant_of_edge, solid_of};
use super::rows::{BitPlaces, LatticeCells, VoxelRows, for_each_bit, moved_up};
use super::{Budget, MeshPart, push_polygon};
use crate::sculpture::Rgb;
use crate::sculpture::history::Contents;

/// The inputs of a slab.
pub struct Slab<'a, P> {
    /// The sculpture.
    pub contents: &'a Contents,
    /// The placement of vertices.
    pub place: &'a P,
    /// Whether vertices have colours.
    pub coloured: bool,
}

/// Returns the bytes of a face of a mesh and of a vertex; a mesh has about as many of each.
pub(crate) fn bytes_of_face(coloured: bool) -> u64 {
    let colour = if coloured { size_of::<Rgb>() } else { 0 };
    (size_of::<[u32; 4]>() + size_of::<Vec3>() + colour) as u64
}

/// The direction of faces: their axis, and whether they face up along it.
type Direction = (usize, bool);

/// The identity of a vertex.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct CornerKey {
    /// The corner of the lattice at the vertex, or at the start of its edge.
    pub corner: [u16; 3],
    /// The slot of the vertex at the corner (as in the layer's [`VertexLayer::further_keys`]; 0 is the first).
    pub place: u8,
}

impl CornerKey {
    /// Appends the keys of the vertices of a layer, in the order of their indices.
    fn list(layer: &VertexLayer, rows: &VoxelRows, z: u32, keys: &mut Vec<CornerKey>) {
        // Along x rows may begin before the grid, but no corner does.
        let [x_0, y_0] = rows.origin().map(|first| first as u16);
        let key = |x: u16, y: usize, place| CornerKey {
            corner: [x_0.wrapping_add(x), y_0 + y as u16, z as u16],
            place,
        };
        for (y, places, _) in layer.rows() {
            keys.extend(places.iter().map(|&x| key(x, y, 0)));
        }
        keys.extend(layer.further_keys().map(|([x, y], place)| key(x as u16, y, place)));
    }
}

/// Reusable memory for making parts.
pub struct SlabScratch<L> {
    near: L,
    corners: RowOfCorners,
    faces: RowOfFaces,
    layers: [VertexLayer; 2],
}

impl<L: Default> SlabScratch<L> {
    /// Returns memory for rows of `width` words.
    pub fn new(width: usize) -> SlabScratch<L> {
        SlabScratch {
            near: L::default(),
            corners: RowOfCorners::new(width),
            faces: RowOfFaces::new(width),
            layers: Default::default(),
        }
    }
}

/// A layer and the index of its first vertex.
struct Numbered<'a> {
    layer: &'a VertexLayer,
    base: u32,
}

impl<P: VertexPlacement> Slab<'_, P> {
    /// Returns the part of the layers `layers` of the lattice; `None` if it exceeds `budget`.
    pub fn part(&self, layers: Range<u32>, budget: &Budget) -> Option<MeshPart> {
        let (first, end) = (i64::from(layers.start), i64::from(layers.end));
        let rows = VoxelRows::of(&self.contents.grid, first - 1..end + 1);
        let mut part = MeshPart::default();
        let mut scratch = SlabScratch::new(rows.width());
        self.fill_part(&rows, layers, &mut scratch, budget, (&mut part, None)).then_some(part)
    }

    /// Replaces `part` by that of a box of cells, and `keys` by its vertices, in their existing memory. Returns false
    /// if `budget` is exceeded. Unlike a part of layers it has all vertices of its faces, including those shared with
    /// later cells.
    pub(crate) fn fill_block(
        &self,
        cells: &LatticeCells,
        scratch: &mut SlabScratch<P::Layer>,
        budget: &Budget,
        (part, keys): (&mut MeshPart, &mut Vec<CornerKey>),
    ) -> bool {
        part.clear();
        keys.clear();
        let rows = VoxelRows::around(&self.contents.grid, cells);
        self.fill_part(&rows, cells.z.clone(), scratch, budget, (part, Some(keys)))
    }

    /// Fills a part that has neither vertices nor faces.
    fn fill_part(
        &self,
        rows: &VoxelRows,
        layers: Range<u32>,
        scratch: &mut SlabScratch<P::Layer>,
        budget: &Budget,
        (part, mut keys): (&mut MeshPart, Option<&mut Vec<CornerKey>>),
    ) -> bool {
        let end = layers.end;
        // A surface has about as many vertices as faces.
        let face_count = rows.faces(layers.clone());
        let kept = part.heap_bytes();
        let counted = (face_count as u64 * bytes_of_face(self.coloured)).saturating_sub(kept);
        if !budget.take(counted) {
            return false;
        }
        part.quads.reserve_exact(face_count);
        part.positions.reserve_exact(face_count);
        if self.coloured {
            part.colours.reserve_exact(face_count);
        }
        let SlabScratch { near, corners: row, faces, layers: [layer, above] } = scratch;
        layer.read(rows, layers.start.into(), row);
        let mut base = 0;
        for z in layers {
            above.read(rows, i64::from(z) + 1, row);
            layer.find_edges_to(above);
            let base_above = base + layer.count() as u32;
            self.put_vertices(layer, rows, near, z as i32, part);
            let both = [Numbered { layer, base }, Numbered { layer: above, base: base_above }];
            put_faces(rows, z, both, faces, part);
            if let Some(keys) = &mut keys {
                CornerKey::list(layer, rows, z, keys);
            }
            std::mem::swap(layer, above);
            base = base_above;
        }
        if let Some(keys) = keys
            && end <= self.contents.grid.dims().z
        {
            self.put_vertices(layer, rows, near, end as i32, part);
            CornerKey::list(layer, rows, end, keys);
        }
        // Separated voxels have more vertices than that.
        budget.take(part.heap_bytes().saturating_sub(kept + counted))
    }

    fn put_vertices(
        &self,
        layer: &VertexLayer,
        rows: &VoxelRows,
        near: &mut P::Layer,
        z: i32,
        part: &mut MeshPart,
    ) {
        let [x_0, y_0] = rows.origin();
        let MeshPart { positions, colours, .. } = part;
        if layer.count() == 0 {
            return;
        }
        self.place.enter(near, z, rows);
        positions.reserve(layer.count());
        for (y, places, octants) in layer.rows() {
            let at = |x: u16| IVec3::new(x_0 + i32::from(x), y_0 + y as i32, z);
            let corners = || places.iter().zip(octants).map(|(&x, &octants)| (x, octants));
            match layer.is_plain_row(y) {
                true => positions
                    .extend(corners().map(|(x, octants)| self.place.only(near, at(x), octants))),
                false => positions.extend(corners().map(|(x, octants)| match layer.is_odd(x, y) {
                    true => self.place.fan(near, at(x), octants, 0),
                    false => self.place.only(near, at(x), octants),
                })),
            }
            if self.coloured {
                colours.extend(
                    corners()
                        .map(|(x, octants)| colour(self.contents, at(x), solid_of(octants, 0))),
                );
            }
        }
        for ([x, y], further) in layer.further() {
            let corner = IVec3::new(x_0 + x as i32, y_0 + y as i32, z);
            let octants = layer.octants_at(x, y);
            let (position, solid) = match further {
                Further::Fan(fan) => {
                    (self.place.fan(near, corner, octants, fan), solid_of(octants, fan))
                }
                Further::Middle { axis, side } => {
                    let octant = octant_of_edge(octants, axis, side);
                    (self.place.middle(near, corner, axis, octant), 1 << octant)
                }
            };
            positions.push(position);
            if self.coloured {
                colours.push(colour(self.contents, corner, solid));
            }
        }
    }
}

/// The buffers for a row while its faces are found.
struct RowOfFaces {
    /// The indices of the corners of rows y and y + 1, in this layer and above; unspecified at other positions.
    numbers: [Vec<u32>; 4],
    /// The faces of a row along each axis, except those with an odd corner.
    faces: [BitPlaces; 3],
    /// The row moved up by one voxel.
    left: Vec<u64>,
}

impl RowOfFaces {
    /// Returns buffers for rows of `width` words.
    fn new(width: usize) -> RowOfFaces {
        RowOfFaces {
            numbers: std::array::from_fn(|_| vec![0; 64 * width]),
            faces: std::array::from_fn(|_| BitPlaces::new(width)),
            left: vec![0; width],
        }
    }
}

/// Adds the faces in a layer of the lattice, and those between it and the layer above.
fn put_faces(
    rows: &VoxelRows,
    z: u32,
    layers: [Numbered; 2],
    row_of_faces: &mut RowOfFaces,
    part: &mut MeshPart,
) {
    let width = layers[0].layer.width;
    let is_plain = layers.iter().all(|numbered| numbered.layer.is_plain());
    let RowOfFaces { numbers, faces, left } = row_of_faces;
    for (i, Numbered { layer, base }) in layers.iter().enumerate() {
        layer.number_row(0, *base, &mut numbers[2 * i]);
    }
    for y in 0..rows.face_rows {
        let has_next = layers[0].layer.has_row(y + 1);
        if has_next {
            for (i, Numbered { layer, base }) in layers.iter().enumerate() {
                layer.number_row(y + 1, *base, &mut numbers[2 * i + 1]);
            }
        }
        let (row, depth) = (y as i64, i64::from(z));
        let [here, below, before] = [(row, depth), (row, depth - 1), (row - 1, depth)];
        let [here, below, before] = [here, below, before].map(|(y, z)| rows.row(y, z));
        faces.iter_mut().for_each(BitPlaces::clear);
        for i in 0..width {
            left[i] = moved_up(here, i);
            let (left, here, below, before) = (left[i], here[i], below[i], before[i]);
            if here == left && here == below && here == before {
                continue;
            }
            let mut odd = 0;
            if !is_plain {
                for Numbered { layer, .. } in &layers {
                    odd |= layer.odd_beside(y, i);
                    odd |= if has_next { layer.odd_beside(y + 1, i) } else { 0 };
                }
            }
            for (faces, other) in faces.iter_mut().zip([left, before, below]) {
                faces.add(i, (other ^ here) & !odd & rows.face_mask[i]);
            }
        }
        if is_plain && faces.iter().all(|faces| faces.of_row().is_empty()) {
            numbers.swap(0, 1);
            numbers.swap(2, 3);
            continue;
        }
        // Faces that look down have their second and fourth vertex swapped.
        let turned = |x: usize, up: &[u64], [first, second, third, fourth]: [u32; 4]| {
            let down = ((up[x / 64] >> (x % 64) & 1) as u32).wrapping_sub(1);
            let swapped = (second ^ fourth) & down;
            [first, second ^ swapped, third, fourth ^ swapped]
        };
        let [a, b, c, d] = numbers.each_ref().map(|row| &row[..64 * width]);
        let quads = &mut part.quads;
        let [along_x, along_y, along_z] =
            faces.each_ref().map(|faces| faces.of_row().iter().map(|&x| usize::from(x)));
        quads.extend(along_x.map(|x| turned(x, left, [a[x], b[x], d[x], c[x]])));
        quads.extend(along_y.map(|x| turned(x, before, [a[x], c[x], c[x] + 1, a[x] + 1])));
        quads.extend(along_z.map(|x| turned(x, below, [a[x], a[x] + 1, b[x] + 1, b[x]])));
        if !is_plain {
            put_odd_faces(rows, [y, z as usize], &layers, part);
        }
        numbers.swap(0, 1);
        numbers.swap(2, 3);
    }
}

/// Adds the faces of a row that [`put_faces`] skips: those with an odd corner.
fn put_odd_faces(
    rows: &VoxelRows,
    [y, z]: [usize; 2],
    layers: &[Numbered; 2],
    part: &mut MeshPart,
) {
    let height = y as i64;
    let here = rows.row(height, z as i64);
    let below = rows.row(height, z as i64 - 1);
    let before = rows.row(height - 1, z as i64);
    for i in 0..layers[0].layer.width {
        let mut odd = 0;
        for Numbered { layer, .. } in layers {
            odd |= layer.odd_beside(y, i);
            odd |= if layer.has_row(y + 1) { layer.odd_beside(y + 1, i) } else { 0 };
        }
        odd &= rows.face_mask[i];
        if odd == 0 {
            continue;
        }
        for (axis, other) in [moved_up(here, i), before[i], below[i]].into_iter().enumerate() {
            for (is_up, faces) in [(true, other & !here[i]), (false, here[i] & !other)] {
                for_each_bit(faces & odd, |bit| {
                    let corner = [64 * i + bit, y, z];
                    put_face(corner, (axis, is_up), layers, part);
                });
            }
        }
    }
}

/// Adds one face with any additional vertices. `corner` is its lowest.
fn put_face(
    corner: [usize; 3],
    (axis, is_up): Direction,
    layers: &[Numbered; 2],
    part: &mut MeshPart,
) {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let mut voxel = corner.map(|at| at as i64);
    voxel[axis] -= i64::from(is_up);
    let (mut vertices, mut middles) = (Vec::with_capacity(8), Vec::new());
    // The corners in order, each with the axis and the lower end of the edge to the next.
    let turn = [([0, 0], u, [0, 0]), ([1, 0], v, [1, 0]), ([1, 1], u, [0, 1]), ([0, 1], v, [0, 0])];
    for ([du, dv], along, start) in turn {
        let moved = |[du, dv]: [usize; 2]| {
            let mut at = corner;
            at[u] += du;
            at[v] += dv;
            let Numbered { layer, base } = &layers[at[2] - corner[2]];
            (at, *layer, *base)
        };
        let ([x, y, _], layer, base) = moved([du, dv]);
        let face = 4 * axis + (1 - du) + 2 * (1 - dv);
        let fan = layer.corner(x, y).map_or(0, |corner| corner.fan_of[face] as usize);
        vertices.push(base + layer.fan(x, y, fan) as u32);
        let (at, layer, base) = moved(start);
        let across = (along + 2) % 3;
        let side = (voxel[across] - at[across] as i64 + 1) as usize;
        if let Some(middle) = layer.middle(at[0], at[1], along, side) {
            middles.push(vertices.len());
            vertices.push(base + middle as u32);
        }
    }
    // Triangles from a vertex in the middle of an edge all have an area.
    vertices.rotate_left(middles.first().copied().unwrap_or(0));
    if !is_up {
        vertices[1..].reverse();
    }
    push_polygon(part, &vertices);
}

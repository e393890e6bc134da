//! A closed surface whose edges can be collapsed: triangles, and for each vertex a list of its triangles.

use std::collections::HashSet;

use glam::Vec3;

use super::cross;
use super::quadric::ErrorQuadric;
use crate::mesh::{GAP_VX, Mesh, MeshPart};
use crate::sculpture::Rgb;

/// Ends a list; marks a removed vertex.
const NONE: u32 = u32::MAX;
/// The least cosine of the angle by which a triangle may rotate.
const LEAST_COSINE: f32 = 0.2;
/// The least ratio of a triangle's area to the square of its longest side, unless it was worse before.
const LEAST_SHAPE: f32 = 0.02;
/// Error per square of an edge's length times its area: in a plane, shorter edges are collapsed first.
const LENGTH_ERROR: f64 = 1e-5;
/// Error per square of a difference of colours (1 from black to white) over an area.
const COLOUR_ERROR: f64 = 0.5;
/// The distance beyond its edge, in lengths of the edge, up to which a vertex may be placed.
const REACH: f32 = 1.0;

/// The collapse of an edge into a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Collapse {
    /// The position of the vertex.
    pub place: Vec3,
    /// The cost of the collapse.
    pub error: f32,
}

/// The surface.
pub struct SimplifiedSurface {
    positions: Vec<Vec3>,
    /// Empty, or one colour per vertex.
    colours: Vec<[f32; 3]>,
    quadrics: Vec<ErrorQuadric>,
    /// Counts the changes of a vertex; [`NONE`] once it is removed.
    versions: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// The first and last corner of each vertex's list, and the next of each corner. Corner `3 t + i` is corner `i` of
    /// triangle `t`. Corners of removed triangles stay in lists until these are walked.
    first: Vec<u32>,
    last: Vec<u32>,
    next: Vec<u32>,
    /// Marks of vertices, current where they equal `mark`.
    marks: Vec<u32>,
    mark: u32,
    /// Kept to avoid allocations.
    around: Vec<u32>,
}

impl SimplifiedSurface {
    /// Returns the surface of all triangles of a mesh.
    pub fn new(mesh: Mesh) -> SimplifiedSurface {
        let positions: Vec<Vec3> = mesh.positions().collect();
        let count = positions.len();
        let triangles: Vec<[u32; 3]> = mesh.triangles().collect();
        let channels = |Rgb(colour): Rgb| colour.map(f32::from);
        let colours = match mesh.is_coloured() {
            true => mesh.colours().map(channels).collect(),
            false => Vec::new(),
        };
        drop(mesh);
        let mut surface = SimplifiedSurface {
            quadrics: vec![ErrorQuadric::default(); count],
            versions: vec![0; count],
            first: vec![NONE; count],
            last: vec![NONE; count],
            next: vec![NONE; 3 * triangles.len()],
            marks: vec![0; count],
            mark: 0,
            around: Vec::new(),
            positions,
            colours,
            triangles,
        };
        for t in 0..surface.triangles.len() {
            let quadric = ErrorQuadric::of_triangle(surface.corners(t));
            for (i, vertex) in surface.triangles[t].into_iter().enumerate() {
                let (vertex, corner) = (vertex as usize, (3 * t + i) as u32);
                surface.quadrics[vertex] = surface.quadrics[vertex].plus(&quadric);
                surface.next[corner as usize] = surface.first[vertex];
                surface.first[vertex] = corner;
                if surface.last[vertex] == NONE {
                    surface.last[vertex] = corner;
                }
            }
        }
        surface
    }

    /// Returns the bytes of a surface of `vertices` and `triangles`: those copied from a mesh while that still exists,
    /// and the total.
    pub(crate) fn needed_bytes(vertices: u64, triangles: u64, is_coloured: bool) -> (u64, u64) {
        let colour = if is_coloured { size_of::<[f32; 3]>() } else { 0 };
        let copied = vertices * (size_of::<Vec3>() + colour) as u64
            + triangles * size_of::<[u32; 3]>() as u64;
        // Versions, first and last corner, marks; the next of each corner.
        let own = vertices * (size_of::<ErrorQuadric>() + 4 * size_of::<u32>()) as u64
            + triangles * size_of::<[u32; 3]>() as u64;
        (copied, copied + own)
    }

    /// Returns all edges, each once, the lower vertex first.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        self.triangles.iter().flat_map(sides).filter(|[from, to]| from < to)
    }

    /// Returns the sum of the versions of both vertices.
    pub fn version(&self, [a, b]: [u32; 2]) -> u32 {
        self.versions[a as usize].wrapping_add(self.versions[b as usize])
    }

    /// Returns whether both vertices still exist.
    pub(crate) fn is_alive(&self, edge: [u32; 2]) -> bool {
        edge.iter().all(|&vertex| self.versions[vertex as usize] != NONE)
    }

    fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// Computes the collapse of the edge, without performing it.
    pub(crate) fn collapse_of(&self, edge: [u32; 2]) -> Collapse {
        let [a, b] = edge.map(|vertex| self.positions[vertex as usize]);
        let [qa, qb] = edge.map(|vertex| &self.quadrics[vertex as usize]);
        let sum = qa.plus(qb);
        let (middle, length) = (0.5 * (a + b), a.distance(b));
        let near = |place: &Vec3| place.distance(middle) <= (0.5 + REACH) * length;
        let best = sum.best().map(|place| place.as_vec3()).filter(near);
        let places = best.map_or([a, b, middle], |best| [best; 3]);
        let errors = places.map(|place| sum.error(place.as_dvec3()));
        // The first among equal ones.
        let at = (1..3).fold(0, |least, i| if errors[i] < errors[least] { i } else { least });
        let area = sum.area();
        let mut error = errors[at] + LENGTH_ERROR * f64::from(length * length) * area;
        if let Some([a, b]) = self.colours_of(edge) {
            let squares = a.iter().zip(b).map(|(a, b)| f64::from((a - b) / 255.0).powi(2));
            error += COLOUR_ERROR * squares.sum::<f64>() / 3.0 * area;
        }
        Collapse { place: places[at], error: error as f32 }
    }

    fn colours_of(&self, edge: [u32; 2]) -> Option<[[f32; 3]; 2]> {
        let is_coloured = !self.colours.is_empty();
        is_coloured.then(|| edge.map(|vertex| self.colours[vertex as usize]))
    }

    /// Returns the triangles of a vertex.
    fn triangles_of(&self, vertex: u32) -> impl Iterator<Item = usize> {
        let some = |corner: u32| (corner != NONE).then_some(corner);
        std::iter::successors(some(self.first[vertex as usize]), move |&corner| {
            some(self.next[corner as usize])
        })
        .map(|corner| corner as usize / 3)
        .filter(|&triangle| self.triangles[triangle][0] != NONE)
    }

    /// Writes the neighbours of a vertex to `out`, each once.
    pub(crate) fn neighbours(&self, vertex: u32, out: &mut Vec<u32>) {
        out.clear();
        // Each triangle contributes the vertex after this one; in a closed fan these are all neighbours.
        out.extend(self.triangles_of(vertex).map(|triangle| {
            let corners = self.triangles[triangle];
            let place = corners.iter().position(|&corner| corner == vertex).unwrap_or(0);
            corners[(place + 1) % 3]
        }));
    }

    /// Returns whether the surface stays a manifold and keeps its shape.
    fn may_collapse(&mut self, edge: [u32; 2], place: Vec3) -> bool {
        let mut around = std::mem::take(&mut self.around);
        let may = self.keeps_manifold(edge, &mut around) && self.keeps_shape(edge, place);
        self.around = around;
        may
    }

    /// Returns whether the link condition holds: both ends have two neighbours in common, which keep three triangles.
    fn keeps_manifold(&mut self, [a, b]: [u32; 2], around: &mut Vec<u32>) -> bool {
        self.neighbours(a, around);
        self.mark = self.mark.wrapping_add(1);
        for &vertex in around.iter() {
            self.marks[vertex as usize] = self.mark;
        }
        self.neighbours(b, around);
        let mark = self.mark;
        let mut both = around.iter().filter(|&&vertex| self.marks[vertex as usize] == mark);
        let (Some(&c), Some(&d), None) = (both.next(), both.next(), both.next()) else {
            return false;
        };
        // Each loses one.
        [c, d].iter().all(|&vertex| self.triangles_of(vertex).take(4).count() == 4)
    }

    /// Returns whether no triangle turns over or becomes a needle.
    fn keeps_shape(&self, [a, b]: [u32; 2], place: Vec3) -> bool {
        [[a, b], [b, a]].into_iter().all(|[own, other]| {
            self.triangles_of(own).all(|triangle| {
                let vertices = self.triangles[triangle];
                if vertices.contains(&other) {
                    return true;
                }
                let before = self.corners(triangle);
                let mut after = before;
                for (corner, vertex) in after.iter_mut().zip(vertices) {
                    if vertex == own {
                        *corner = place;
                    }
                }
                let (old, new) = (cross(before), cross(after));
                let shape = shape(after);
                old.dot(new) > LEAST_COSINE * old.length() * new.length()
                    && (shape > LEAST_SHAPE || shape > self::shape(before))
            })
        })
    }

    /// Moves `b` into `a` at the position of `collapse`. Returns false if that is not allowed.
    pub(crate) fn try_collapse(&mut self, [a, b]: [u32; 2], collapse: &Collapse) -> bool {
        if !self.may_collapse([a, b], collapse.place) {
            return false;
        }
        let (to, from) = (a as usize, b as usize);
        let gone: Vec<usize> =
            self.triangles_of(b).filter(|&t| self.triangles[t].contains(&a)).collect();
        for triangle in gone {
            self.triangles[triangle] = [NONE; 3];
        }
        let moved: Vec<usize> = self.triangles_of(b).collect();
        for triangle in moved {
            for vertex in &mut self.triangles[triangle] {
                *vertex = if *vertex == b { a } else { *vertex };
            }
        }
        self.next[self.last[to] as usize] = self.first[from];
        self.last[to] = self.last[from];
        self.prune(to);
        let shares = [a, b].map(|vertex| self.quadrics[vertex as usize].area() as f32);
        if let Some([own, other]) = self.colours_of([a, b]) {
            let share = shares[1] / (shares[0] + shares[1]).max(f32::MIN_POSITIVE);
            self.colours[to] = std::array::from_fn(|i| own[i] + (other[i] - own[i]) * share);
        }
        self.quadrics[to] = self.quadrics[to].plus(&self.quadrics[from]);
        self.positions[to] = collapse.place;
        self.versions[to] = self.versions[to].wrapping_add(1);
        self.versions[from] = NONE;
        true
    }

    /// Removes deleted triangles from a vertex's list.
    fn prune(&mut self, vertex: usize) {
        let mut corner = self.first[vertex];
        let (mut first, mut last) = (NONE, NONE);
        while corner != NONE {
            if self.triangles[corner as usize / 3][0] != NONE {
                match last {
                    NONE => first = corner,
                    last => self.next[last as usize] = corner,
                }
                last = corner;
            }
            corner = self.next[corner as usize];
        }
        if last != NONE {
            self.next[last as usize] = NONE;
        }
        (self.first[vertex], self.last[vertex]) = (first, last);
    }

    /// Returns the remaining surface.
    pub(crate) fn into_part(mut self) -> MeshPart {
        self.move_apart();
        let mut part = MeshPart::default();
        let mut numbers = vec![NONE; self.positions.len()];
        for (vertex, number) in numbers.iter_mut().enumerate() {
            if self.versions[vertex] == NONE {
                continue;
            }
            *number = part.positions.len() as u32;
            part.positions.push(self.positions[vertex]);
            if let Some(colour) = self.colours.get(vertex) {
                part.colours.push(Rgb(colour.map(|channel| (channel + 0.5) as u8)));
            }
        }
        let left = self.triangles.iter().filter(|triangle| triangle[0] != NONE);
        part.triangles = left.map(|t| t.map(|vertex| numbers[vertex as usize])).collect();
        part
    }

    /// Moves coincident vertices towards their neighbours, as formats without shared vertices require.
    fn move_apart(&mut self) {
        let mut taken = HashSet::new();
        let mut neighbours = Vec::new();
        for vertex in 0..self.positions.len() as u32 {
            let at = vertex as usize;
            if self.versions[at] == NONE {
                continue;
            }
            let mut share = GAP_VX;
            while !taken.insert(self.positions[at].to_array().map(f32::to_bits)) && share < 1.0 {
                self.neighbours(vertex, &mut neighbours);
                let sum: Vec3 = neighbours.iter().map(|&v| self.positions[v as usize]).sum();
                let mean = sum / neighbours.len() as f32;
                self.positions[at] = self.positions[at].lerp(mean, share);
                share *= 2.0;
            }
        }
    }
}

/// Returns the ratio of a triangle's area to the square of its longest side.
fn shape(corners: [Vec3; 3]) -> f32 {
    let [a, b, c] = corners;
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    0.5 * cross(corners).length() / longest.max(f32::MIN_POSITIVE)
}

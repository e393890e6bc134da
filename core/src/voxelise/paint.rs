//! Colours of the surface: each voxel beside a crossing takes the colour of the nearest triangle among those that cross
//! beside it.

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::crossings::{MeshRay, RaySlab, SUB_VX};
use super::{CutMesh, InputMesh, VoxeliseError, check_memory};
use crate::sculpture::brick::{BRICK_EDGE_VX, local_coords, local_index};
use crate::sculpture::grid::LEAF_EDGE_VX;
use crate::sculpture::material::{MAX_PAGE_BYTES, Page};
use crate::sculpture::{Grid, Material, Rgb};

/// Layers of bricks that are coloured between two checks of memory and cancellation: those of a slab.
const LAYERS: usize = (LEAF_EDGE_VX / BRICK_EDGE_VX) as usize;

/// The data from which colours are computed.
pub(super) struct Painter<'a> {
    pub mesh: &'a InputMesh,
    pub cut: &'a CutMesh<'a>,
    pub is_shell: bool,
}

/// A triangle beside a voxel: brick in the layer, voxel in the brick (9 bits), and triangle (32 bits).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct VoxelTriangle(u64);

impl Painter<'_> {
    /// Gives the voxels of `grid` at the mesh's surface their colours.
    pub fn paint(
        &self,
        grid: &Grid,
        material: &mut Material,
        budget_bytes: u64,
    ) -> Result<(), VoxeliseError> {
        let CutMesh { placed, slabs, progress, .. } = self.cut;
        progress.begin("colouring");
        let lists = slabs.iter().map(|slabs| slabs.bytes()).sum::<u64>()
            + slabs[2].all_crossings * size_of::<VoxelTriangle>() as u64;
        check_memory(lists, budget_bytes)?;
        let layers = grid.brick_dims().z as usize;
        // Rays along z run through all layers.
        let mut of_layer = vec![Vec::new(); layers];
        for slab in 0..slabs[2].count() {
            self.cut.go_on()?;
            let along_z = placed.cross(&slabs[2], slab);
            let rays = along_z.rays();
            self.besides(grid, &along_z, rays, &mut |layer, beside| of_layer[layer].push(beside));
        }
        for (slab, batch) in (0..).zip(of_layer.chunks_mut(LAYERS)) {
            self.cut.go_on()?;
            progress.advance(slab as f32 / slabs[0].count() as f32);
            let across = [0, 1].map(|axis| placed.cross(&slabs[axis], slab));
            let material_now = &*material;
            let pages: Vec<Vec<(UVec3, Page)>> = batch
                .par_iter_mut()
                .enumerate()
                .map(|(i, beside)| {
                    let mut beside = std::mem::take(beside);
                    self.gather(grid, &across, i as u32, &mut beside);
                    self.pages(grid, material_now, slab as usize * LAYERS + i, &beside)
                })
                .collect();
            let bytes = pages.iter().flatten().map(|(_, page)| page.heap_bytes() as u64);
            let (count, bytes) = (pages.iter().map(Vec::len).sum::<usize>(), bytes.sum());
            let needed = material.heap_bytes() + material.bytes_for_pages(count as u64, bytes);
            check_memory(needed, budget_bytes)?;
            material.set_pages(pages.into_iter().flatten().collect());
        }
        progress.end();
        Ok(())
    }

    /// Adds the crossings of rays along x and y in a layer of bricks of a slab, and sorts all by voxels.
    fn gather(
        &self,
        grid: &Grid,
        across: &[RaySlab; 2],
        layer: u32,
        beside: &mut Vec<VoxelTriangle>,
    ) {
        let slices = layer * BRICK_EDGE_VX..(layer + 1) * BRICK_EDGE_VX;
        for (rays, size) in across.iter().zip([grid.dims().y, grid.dims().x]) {
            let of_layer = slices.clone().flat_map(|slice| rays.rays_of(0..size, slice));
            self.besides(grid, rays, of_layer, &mut |_, found| beside.push(found));
        }
        beside.sort_unstable();
        beside.dedup();
    }

    /// Calls `f` with the layer of bricks of each voxel that a crossing colours.
    fn besides<'r>(
        &self,
        grid: &Grid,
        slab: &RaySlab,
        rays: impl Iterator<Item = MeshRay<'r>>,
        f: &mut dyn FnMut(usize, VoxelTriangle),
    ) {
        let count = grid.dims()[slab.axis];
        let bricks = grid.brick_dims();
        let mut put = |v: UVec3, triangle: usize| {
            let (brick, local) = (v / BRICK_EDGE_VX, v % BRICK_EDGE_VX);
            let brick_in_layer = u64::from(brick.x + bricks.x * brick.y);
            let place = brick_in_layer << 9 | u64::from(local_index(local.x, local.y, local.z));
            f(brick.z as usize, VoxelTriangle(place << 32 | triangle as u64));
        };
        for ray in rays {
            for crossing in ray.crossings {
                let at = |along: u32| slab.voxel(&ray, along);
                let exists = |along: u32| grid.get(at(along).as_ivec3());
                let mut sides = crossing.sides(count).filter(|along| exists(*along));
                let (first, second) = (sides.next(), sides.next());
                // With voxels on both sides, there is no surface of a solid here.
                for along in [first, second].into_iter().flatten() {
                    if self.is_shell || second.is_none() {
                        put(at(along), crossing.triangle());
                    }
                }
            }
        }
    }

    /// Returns the pages of a layer of bricks.
    fn pages(
        &self,
        grid: &Grid,
        material: &Material,
        layer: usize,
        beside: &[VoxelTriangle],
    ) -> Vec<(UVec3, Page)> {
        let (depth, bricks) = (material.depth(), grid.brick_dims());
        let of_brick = beside.chunk_by(|a, b| a.0 >> 41 == b.0 >> 41);
        of_brick
            .map(|beside| {
                let in_layer = (beside[0].0 >> 41) as u32;
                let brick = UVec3::new(in_layer % bricks.x, in_layer / bricks.x, layer as u32);
                let mut buffer = [0; MAX_PAGE_BYTES];
                let page = &mut buffer[..material.page_bytes()];
                let base = material.base();
                page.chunks_exact_mut(depth.bytes()).for_each(|colour| depth.write(base, colour));
                for beside in beside.chunk_by(|a, b| a.0 >> 32 == b.0 >> 32) {
                    let local = (beside[0].0 >> 32 & 511) as u32;
                    let v = brick * BRICK_EDGE_VX + UVec3::from(local_coords(local));
                    let colour = self.colour(v, beside);
                    depth.write(colour, &mut page[local as usize * depth.bytes()..]);
                }
                (brick, Page::of_bytes(page, depth))
            })
            .collect()
    }

    fn colour(&self, v: UVec3, beside: &[VoxelTriangle]) -> Rgb {
        let centre = v.as_vec3() + 0.5;
        let mut best = (f32::INFINITY, 0, Vec3::X);
        for beside in beside {
            let triangle = (beside.0 & 0xFFFF_FFFF) as usize;
            let corners = self.cut.placed.triangle(triangle).map(|c| c.as_vec3() / SUB_VX as f32);
            let weights = nearest(centre, corners);
            let [a, b, c] = weights.to_array();
            let at = corners[0] * a + corners[1] * b + corners[2] * c;
            let distance = at.distance_squared(centre);
            if distance < best.0 {
                best = (distance, triangle, weights);
            }
        }
        self.mesh.colour(best.1, best.2)
    }
}

/// Returns the barycentric weights of the point of a triangle that is nearest to `p`.
pub(super) fn nearest(p: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return Vec3::X;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return Vec3::Y;
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return Vec3::Z;
    }
    let (in_c, in_b, in_a) = (d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4);
    if in_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return Vec3::new(1.0 - t, t, 0.0);
    }
    if in_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return Vec3::new(1.0 - t, 0.0, t);
    }
    if in_a <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return Vec3::new(0.0, 1.0 - t, t);
    }
    let sum = in_a + in_b + in_c;
    if sum > 0.0 { Vec3::new(in_a, in_b, in_c) / sum } else { Vec3::X }
}

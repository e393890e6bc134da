//! Compares the thickness of thin parts in the smooth mesh with that of their voxels.

use std::f32::consts::FRAC_PI_4;

use glam::{EulerRot, IVec3, Quat, UVec3, Vec3};

use super::surfaces::{contents, mesh};
use crate::mesh::MeshKind;
use crate::scenes::grid_of;
use crate::sculpture::Grid;
use crate::sculpture::region::VoxelBox;
use crate::tools::solid::{Primitive, Solid};

const EDGE_VX: u32 = 64;
/// The largest deviation of a part's thickness from that of its voxels.
const TOLERANCE_VX: f64 = 0.25;

/// Returns rotations of parts: along the axes, and away from all axes.
fn turns() -> [(&'static str, Quat); 6] {
    [
        ("along an axis", Quat::IDENTITY),
        ("10 degrees", Quat::from_rotation_x(10f32.to_radians())),
        ("27 degrees", Quat::from_rotation_x(26.57f32.to_radians())),
        ("45 degrees", Quat::from_rotation_x(FRAC_PI_4)),
        ("across all axes", Quat::from_rotation_arc(Vec3::Y, Vec3::ONE.normalize())),
        ("skew", Quat::from_euler(EulerRot::XYZ, 0.5, 0.3, 0.7)),
    ]
}

/// Returns a grid with a cuboid in its middle.
fn cuboid(half: Vec3, turn: Quat, off: Vec3) -> Grid {
    let solid = Primitive {
        solid: Solid::Cuboid,
        centre_vx: Vec3::splat(EDGE_VX as f32 / 2.0) + off,
        half,
        rotation: turn,
    };
    let region = solid.in_grid(Vec3::ONE);
    let mut grid = Grid::new(UVec3::splat(EDGE_VX), Vec3::ONE, 1 << 30).unwrap();
    let all = VoxelBox::of_grid(&grid);
    for z in all.min.z..all.max.z {
        for y in all.min.y..all.max.y {
            for x in all.min.x..all.max.x {
                let v = IVec3::new(x, y, z);
                grid.set(v, region.contains_voxel(v));
            }
        }
    }
    grid
}

/// Returns the volume of the smooth mesh of a grid, and its number of voxels.
fn volumes(grid: Grid) -> [f64; 2] {
    let voxels = grid.opaque_count() as f64;
    [mesh(&contents(grid), MeshKind::Smooth).volume_vx(), voxels]
}

/// Returns the difference in length, area or thickness between two parts, so that the effects of ends and rims cancel.
fn without_rims(small: Grid, large: Grid, per: f64) -> [f64; 2] {
    let [small, large] = [small, large].map(volumes);
    [0, 1].map(|i| ((large[i] - small[i]) / per).max(0.0))
}

/// The differences of a kind of part from its voxels: the thinnest, and the thickest.
struct Row {
    part: String,
    range_vx: [f64; 2],
}

impl Row {
    fn new(part: String) -> Row {
        Row { part, range_vx: [f64::INFINITY, f64::NEG_INFINITY] }
    }

    fn add(&mut self, [smooth, voxels]: [f64; 2]) {
        let [least, most] = &mut self.range_vx;
        (*least, *most) = (least.min(smooth - voxels), most.max(smooth - voxels));
    }

    /// Returns the row as in the table of the documentation.
    fn text(&self) -> String {
        // Avoids a negative zero.
        let [least, most] = self.range_vx.map(|vx| (vx * 100.0).round() / 100.0 + 0.0);
        format!("| {} | {least:+.2} | {most:+.2} |", self.part)
    }
}

#[test]
fn thin_parts_keep_their_thickness_and_the_documentation_says_how_well() {
    let mut rows = Vec::new();
    for thick in 1..=4 {
        let half = thick as f32 / 2.0;
        let mut plates = Row::new(format!("plate of {thick}"));
        let mut bars = Row::new(format!("bar of {thick} x {thick}"));
        let mut shells = Row::new(format!("wall of {thick} around a ball"));
        // Between voxels if an even number fits, and anywhere.
        let between = if thick % 2 == 1 { Vec3::splat(0.5) } else { Vec3::ZERO };
        for (turn, off) in turns()
            .into_iter()
            .flat_map(|(_, turn)| [(turn, between), (turn, Vec3::new(0.3, 0.17, 0.41))])
        {
            let plate = |wide: f32| cuboid(Vec3::new(wide, half, wide), turn, off);
            plates.add(without_rims(plate(10.0), plate(20.0), 40.0 * 40.0 - 20.0 * 20.0));
            let bar = |long: f32| cuboid(Vec3::new(half, long, half), turn, off);
            bars.add(without_rims(bar(10.0), bar(26.0), 32.0).map(f64::sqrt));
        }
        for radius in [12.0, 20.0, 29.3] {
            let shell = grid_of(EDGE_VX, |p| ((p - 31.7).length() - radius).abs() < half);
            let area = 4.0 * std::f64::consts::PI * f64::from(radius).powi(2);
            shells.add(volumes(shell).map(|volume| volume / area));
        }
        rows.extend([plates, bars, shells]);
    }
    let said = include_str!("../../../../docs/printing.md");
    let mut faults = Vec::new();
    for row in rows {
        let [least, most] = row.range_vx;
        if least < -TOLERANCE_VX || most > TOLERANCE_VX {
            faults.push(format!("too far from its voxels: {}", row.text()));
        }
        if !said.contains(&row.text()) {
            faults.push(format!("not in docs/printing.md: {}", row.text()));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

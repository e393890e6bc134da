//! Paints each voxel with a colour of its own, for images, translucent brushes and clips, where
//! [`edit`](super::edit::edit) gives all voxels one colour.
//!
//! Takes the contents, a [`Region`] and a function of voxel and present colour; stores the earlier
//! colours in the recorder and marks bricks dirty. Changes no existence bits.

use glam::UVec3;

use super::brick::{BRICK_EDGE_VX, local_coords};
use super::brick_set::BrickSet;
use super::colour::Rgb;
use super::contents::Contents;
use super::edit_stats::EditStats;
use super::region::Region;
use super::stroke::StrokeRecorder;
use super::to_paint::{PaintTarget, for_each_portion};

/// Gives every existing voxel of `region` the colour that `colour` returns for its coordinates and its present colour.
/// Does nothing without colour depth.
pub fn paint_each(
    contents: &mut Contents,
    region: &impl Region,
    colour: impl Fn(UVec3, Rgb) -> Rgb + Sync,
    recorder: &mut StrokeRecorder,
    dirty: &mut BrickSet,
) -> EditStats {
    let Contents { grid, material, .. } = contents;
    let mut stats = EditStats::default();
    if material.depth().bytes() == 0 {
        return stats;
    }
    recorder.begin_painting(material);
    let one = |b: UVec3, local: u32, now: Rgb| {
        colour(b * BRICK_EDGE_VX + UVec3::from(local_coords(local)), now)
    };
    for_each_portion(grid, region, PaintTarget::Existing, false, &mut |voxels| {
        let painted = material.paint_bricks_by(&voxels.bricks, &one);
        recorder.close_painting(&painted, dirty);
        stats.voxels_recoloured += painted.voxels;
        stats.bricks_changed += painted.bricks;
    });
    stats
}

#[cfg(test)]
mod tests {
    use glam::{IVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::sculpture::brick::{BRICK_VOXELS, Brick};
    use crate::sculpture::region::VoxelBox;
    use crate::sculpture::{ColourDepth, Grid, Material};

    fn colour_at(v: UVec3, now: Rgb) -> Rgb {
        let [r, g, b] = now.0;
        Rgb::new(r.wrapping_add((v.x * 7) as u8), g.wrapping_add((v.y * 11) as u8), b ^ v.z as u8)
    }

    proptest! {
        #[test]
        fn each_voxel_gets_its_colour_and_the_record_takes_it_back(
            dims in prop::array::uniform3(1u32..70),
            from in prop::array::uniform3(-5i32..60),
            size in prop::array::uniform3(1i32..60),
            depth in prop::sample::select(&ColourDepth::ALL[..]),
            sparse in 1u32..5,
        ) {
            let dims = UVec3::from(dims);
            let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
            grid.fill_bricks(|b| if (b.x + b.y + b.z) % sparse == 0 {
                Brick { words: [0x5a5a_ffff_1234_8001 ^ u64::from(b.x); 8] }
            } else {
                Brick::EMPTY
            });
            let material = Material::for_grid(&grid, depth, Rgb::STONE);
            let mut contents = Contents::new(grid, material);
            let start = contents.clone();
            let mut recorder = StrokeRecorder::default();
            let mut dirty = BrickSet::default();
            let min = IVec3::from(from);
            let region = VoxelBox { min, max: min + IVec3::from(size) };
            // Twice, so that the second time finds pages.
            for _ in 0..2 {
                let before = contents.clone();
                let stats =
                    paint_each(&mut contents, &region, colour_at, &mut recorder, &mut dirty);
                let mut painted = 0;
                for index in 0..before.grid.brick_count() {
                    for local in 0..BRICK_VOXELS {
                        let [x, y, z] = local_coords(local);
                        let v = before.grid.brick_coords(index) * BRICK_EDGE_VX
                            + UVec3::new(x, y, z);
                        let b = before.grid.brick_coords(index);
                        let was = before.material.rgb(b, local);
                        let meant = before.grid.get(v.as_ivec3()) && region.contains(v.as_ivec3());
                        let wanted = match meant && depth != ColourDepth::None {
                            true => depth.quantise(colour_at(v, was)),
                            false => was,
                        };
                        painted += u64::from(wanted != was);
                        prop_assert_eq!(contents.material.rgb(b, local), wanted);
                    }
                }
                prop_assert_eq!(stats.voxels_recoloured, painted);
                prop_assert_eq!(&contents.grid, &before.grid);
            }
            recorder.finish().swap(&mut contents, &mut dirty);
            prop_assert_eq!(contents, start);
        }
    }
}

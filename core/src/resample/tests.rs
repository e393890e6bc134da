use super::*;
use crate::progress::ProgressReport;
use crate::sculpture::{ColourDepth, Rgb};

/// Returns a ball, half of it red, with a mask in a corner.
fn ball(edge: u32, radius: f32) -> Contents {
    let mut grid = Grid::new(UVec3::splat(edge), Vec3::new(1.0, 2.0, 0.5), 1 << 30).unwrap();
    let middle = edge as f32 / 2.0;
    grid.fill_bricks(|b| gather(b, |v| (v.as_vec3() + 0.5 - middle).length() < radius));
    let mut material = Material::for_grid(&grid, ColourDepth::Bits24, Rgb::STONE);
    for at in 0..grid.brick_count() {
        let b = grid.brick_coords(at);
        if b.x * 2 < grid.brick_dims().x {
            material.paint(b, &Brick::FULL, Rgb::new(255, 0, 0));
        }
    }
    let mut mask = grid.emptied();
    mask.fill_bricks(|b| if b == UVec3::ZERO { Brick::FULL } else { Brick::EMPTY });
    Contents { mask: Some(Box::new(mask)), ..Contents::new(grid, material) }
}

#[test]
fn the_shape_keeps_its_size_in_the_world() {
    let before = ball(48, 20.0);
    let volume = |contents: &Contents| {
        let voxel = contents.grid.voxel_size().as_dvec3().element_product();
        contents.grid.opaque_count() as f64 * voxel
    };
    for to in [
        Resolution::Factor(0.5),
        Resolution::Factor(2.0),
        Resolution::Factor(1.5),
        Resolution::Dims(UVec3::new(30, 48, 100)),
    ] {
        let after = resampled(&before, to, &Limits::default(), &()).unwrap();
        let size =
            |contents: &Contents| contents.grid.dims().as_vec3() * contents.grid.voxel_size();
        assert!(size(&after).abs_diff_eq(size(&before), 1e-3), "{to:?}");
        let change = volume(&after) / volume(&before);
        assert!((0.97..1.03).contains(&change), "{to:?}: {change}");
        assert_eq!(after.frame, CanvasFrame::of(after.grid.dims()));
        let masked = after.mask.as_ref().unwrap().opaque_count() as f64;
        let share = masked / after.grid.dims().as_u64vec3().element_product() as f64;
        assert!((share * 216.0 - 1.0).abs() < 0.5, "{to:?}: {share}");
        // Every voxel has one of the two colours, on its side.
        let dims = after.grid.dims();
        for at in 0..dims.element_product() {
            let v = after.grid.voxel_coords(at);
            let Some(colour) = after.colour(v.as_ivec3()) else { continue };
            let side = (v.x as f32 + 0.5) / dims.x as f32;
            if (side - 0.5).abs() > 0.05 {
                let red = Rgb::new(255, 0, 0);
                assert_eq!(colour, if side < 0.5 { red } else { Rgb::STONE }, "{to:?} {v}");
            }
        }
    }
}

#[test]
fn the_same_resolution_changes_no_voxel() {
    let before = ball(40, 13.0);
    let after = resampled(&before, Resolution::Factor(1.0), &Limits::default(), &()).unwrap();
    assert_eq!(after.grid, before.grid);
    assert_eq!(after.mask, before.mask);
}

#[test]
fn work_that_is_impossible_or_cancelled_gives_nothing() {
    let before = ball(24, 9.0);
    for (to, part) in [
        (Resolution::Factor(0.0), "factor"),
        (Resolution::Factor(f32::NAN), "factor"),
        (Resolution::Dims(UVec3::new(0, 1, 1)), "grid of"),
        (Resolution::Dims(UVec3::new(10, 9000, 10)), "8192"),
    ] {
        let error = resampled(&before, to, &Limits::default(), &()).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
    let report = ProgressReport::default();
    report.cancel();
    let result = resampled(&before, Resolution::Factor(2.0), &Limits::default(), &report);
    assert!(matches!(result, Err(ResampleError::Cancelled)));
    let limits = Limits { colour_bytes: 64, ..Limits::default() };
    let result = resampled(&before, Resolution::Factor(2.0), &limits, &());
    assert!(matches!(result, Err(ResampleError::OverBudget(_))));
    // As much as the field of the former resolution takes.
    let grid_bytes = Grid::bytes_for(before.grid.dims()) * 16;
    let limits = Limits { grid_bytes, ..Limits::default() };
    let result = resampled(&before, Resolution::Factor(8.0), &limits, &());
    assert!(matches!(result, Err(ResampleError::OverBudget(_))), "{result:?}");
}

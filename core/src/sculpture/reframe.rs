//! Moves the box of a sculpture: it grows or shrinks at any side. Voxels, colours and mask within both boxes stay.
//!
//! Lower sides move by whole leaves, so that the trees are rebuilt from shared leaves; only those at the borders are
//! computed. Takes contents and a canvas, and returns new contents. Knows no document.

use glam::IVec3;
use thiserror::Error;

use super::canvas_frame::{CANVAS_STEP_VX, Canvas};
use super::contents::Contents;
use super::{Grid, GridError, Limits, grid, material};
use crate::refusal::{InvalidValue, MemoryBudget, OverBudget};

/// Why the box of a sculpture cannot be moved.
#[derive(Debug, Error)]
pub enum CanvasError {
    /// A grid of this size is not possible.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The voxels or colours would not fit into the limits.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// The box cannot lie there.
    #[error(transparent)]
    Invalid(#[from] InvalidValue),
}

/// Returns an error if the contents cannot have the canvas, whatever memory they then take.
pub fn check_canvas(contents: &Contents, to: &Canvas) -> Result<(), CanvasError> {
    let (grid, from) = (&contents.grid, contents.canvas());
    to.frame.check()?;
    let step = (from.frame.origin - to.frame.origin) % CANVAS_STEP_VX as i32;
    let rule = "must differ by multiples of 64 voxels from the former one";
    InvalidValue::check(step == IVec3::ZERO, "lower corner of the canvas", rule, to.frame.origin)?;
    Grid::check_size(to.dims, grid.voxel_size())?;
    Ok(())
}

/// Returns the contents in another box.
///
/// # Errors
/// If the box is not possible within `limits`.
pub fn reframed(
    contents: &Contents,
    to: &Canvas,
    limits: &Limits,
) -> Result<Contents, CanvasError> {
    check_canvas(contents, to)?;
    let shift = (contents.frame.origin - to.frame.origin) / CANVAS_STEP_VX as i32;
    let of_bits = |bits: &Grid| grid::reframed(bits, to.dims, shift);
    let mut result = Contents {
        grid: of_bits(&contents.grid),
        material: material::reframed(&contents.material, to.dims, shift),
        mask: contents.mask.as_ref().map(|mask| Box::new(of_bits(mask))),
        surface: contents.surface,
        frame: to.frame,
    };
    result.drop_empty_mask();
    // Only what a border cuts takes more than before: bricks in one layer at each side.
    let bits =
        |of: &Contents| of.grid.heap_bytes() + of.mask.as_ref().map_or(0, |m| m.heap_bytes());
    let colours = |of: &Contents| of.material.heap_bytes();
    for (before, after, purpose, budget) in [
        (bits(contents), bits(&result), MemoryBudget::Grids, limits.grid_bytes),
        (colours(contents), colours(&result), MemoryBudget::Colours, limits.colour_bytes),
    ] {
        if after > before {
            OverBudget::check("this needs", after, purpose, budget)?;
        }
    }
    Ok(result)
}

/// Returns bits of the same box in another one, which must be possible for the contents.
pub(crate) fn reframed_bits(bits: &Grid, from: &Canvas, to: &Canvas) -> Grid {
    let shift = (from.frame.origin - to.frame.origin) / CANVAS_STEP_VX as i32;
    grid::reframed(bits, to.dims, shift)
}

/// Returns whether the contents can be restored from the result of [`reframed`]: nothing was cut off.
pub fn keeps_all(before: &Contents, after: &Contents) -> bool {
    let masked = |contents: &Contents| contents.mask.as_ref().map_or(0, |mask| mask.opaque_count());
    before.grid.opaque_count() == after.grid.opaque_count()
        && before.material.page_count() == after.material.page_count()
        && masked(before) == masked(after)
}

#[cfg(test)]
mod tests {
    use glam::{UVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::scenes::Random;
    use crate::sculpture::brick::Brick;
    use crate::sculpture::canvas_frame::CanvasFrame;
    use crate::sculpture::region::VoxelBox;
    use crate::sculpture::{ColourDepth, Material, Rgb};

    /// Returns full, empty and mixed bricks, and pages of one and of many colours.
    fn scattered(dims: UVec3, depth: ColourDepth, seed: u64) -> Contents {
        let mut grid = Grid::new(dims, Vec3::ONE, 1 << 30).unwrap();
        grid.fill_bricks(|b| {
            let mut random = Random(seed ^ u64::from(b.x + 64 * b.y + 4096 * b.z) << 9);
            match (random.next_u64() % 4, (b / 8 + seed as u32) % 3) {
                (_, part) if part == UVec3::ZERO => Brick::FULL,
                (0, _) => Brick::EMPTY,
                (1, _) => Brick::FULL,
                _ => Brick { words: std::array::from_fn(|_| random.next_u64()) },
            }
        });
        let mut material = Material::new(depth, Rgb::STONE, dims);
        let mut random = Random(seed);
        let all = random.next_u64().is_multiple_of(2);
        for at in 0..grid.brick_count() {
            let b = grid.brick_coords(at);
            match random.next_u64() % 8 {
                0 => material.paint_each(b, &Brick::FULL, |i| Rgb([i as u8, 3, 4])),
                1..4 => {}
                _ if all => material.paint(b, &Brick::FULL, Rgb([9, 8, 7])),
                _ => {}
            }
        }
        let mut mask = grid.emptied();
        mask.fill_bricks(|b| if b.x == b.y { Brick::FULL } else { Brick::EMPTY });
        let mask = (!seed.is_multiple_of(3)).then(|| Box::new(mask));
        Contents { mask, ..Contents::new(grid, material) }
    }

    /// Compares with the definition, voxel by voxel.
    fn check(from: &Contents, to: &Canvas) -> Contents {
        let after = reframed(from, to, &Limits::default()).unwrap();
        assert_eq!(after.canvas(), *to);
        let shift = from.frame.origin - to.frame.origin;
        let mut counted = after.grid.emptied();
        for index in 0..to.dims.element_product() {
            let v = after.grid.voxel_coords(index);
            let source = v.as_ivec3() - shift;
            assert_eq!(after.grid.get(v.as_ivec3()), from.grid.get(source), "{v}");
            assert_eq!(after.is_masked(v.as_ivec3()), from.is_masked(source), "{v}");
            if from.grid.contains(source) {
                assert_eq!(after.rgb(v), from.rgb(source.as_uvec3()), "{v}");
            }
        }
        counted.fill_bricks(|b| *after.grid.brick(b));
        assert_eq!(counted, after.grid, "canonical");
        assert_eq!(counted.opaque_count(), after.grid.opaque_count());
        let mut painted =
            Material::new(after.material.depth(), after.material.base(), after.grid.dims());
        let pages = (0..after.grid.brick_count()).filter_map(|at| {
            let b = after.grid.brick_coords(at);
            after.material.page(b).map(|page| (b, page.to_page()))
        });
        painted.set_pages(pages.collect());
        assert_eq!(painted, after.material, "canonical");
        assert_eq!(painted.heap_bytes(), after.material.heap_bytes());
        assert_eq!(painted.page_count(), after.material.page_count());
        after
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn what_lies_in_both_boxes_stays(
            dims in prop::array::uniform3(prop_oneof![1u32..90, Just(64)]),
            low in prop::array::uniform3(-1i32..2),
            other in prop::array::uniform3(1u32..140),
            depth in prop::sample::select(&ColourDepth::ALL[..]),
            seed: u64,
        ) {
            let from = scattered(dims.into(), depth, seed);
            let origin = IVec3::from(low) * 64;
            let to = Canvas {
                dims: other.into(),
                frame: CanvasFrame { origin, ..from.frame },
            };
            let after = check(&from, &to);
            let back = check(&after, &from.canvas());
            if keeps_all(&from, &after) {
                prop_assert_eq!(&back, &from);
                prop_assert_eq!(back.kept_bytes(), from.kept_bytes());
            }
            // A larger box keeps everything.
            let around = from.canvas().grown_by(UVec3::from(other), UVec3::from(other) % 80);
            let grown = reframed(&from, &around, &Limits::default()).unwrap();
            prop_assert!(keeps_all(&from, &grown));
            prop_assert_eq!(&reframed(&grown, &from.canvas(), &Limits::default()).unwrap(), &from);
        }
    }

    #[test]
    fn impossible_boxes_are_refused() {
        let from = scattered(UVec3::splat(20), ColourDepth::Bits8, 1);
        let to = |origin: [i32; 3], dims: [u32; 3]| Canvas {
            dims: dims.into(),
            frame: CanvasFrame { origin: origin.into(), ..from.frame },
        };
        for (to, part) in [
            (to([-63, 0, 0], [90; 3]), "multiples of 64"),
            (to([1 << 20, 0, 0], [90; 3]), "too far"),
            (to([0; 3], [9000, 1, 1]), "8192"),
        ] {
            let error = reframed(&from, &to, &Limits::default()).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        // A full cube takes next to nothing, but not its sides within a larger box, if they divide bricks.
        let dims = UVec3::splat(508);
        let mut grid = Grid::of_size(dims, Vec3::ONE).unwrap();
        grid.fill_box(VoxelBox::of_grid(&grid));
        let full = Contents::new(grid, Material::new(ColourDepth::Bits8, Rgb::STONE, dims));
        let small = Limits { grid_bytes: 100_000, ..Limits::default() };
        let to = |edge| {
            let to = Canvas { dims: UVec3::splat(edge), frame: full.frame };
            reframed(&full, &to, &small)
        };
        assert_eq!(to(448).unwrap().grid.opaque_count(), 448 * 448 * 448);
        let error = to(1000).unwrap_err().to_string();
        assert!(error.contains("MiB"), "{error}");
    }
}

//! Tests the descriptions of brushes, and the voxels that those under an outline add, remove and paint.

use std::collections::HashSet;

use super::change::{BrushChange, NewClay, Paint, Site};
use super::dab::{Dab, DabPlace};
use super::footprint::{Coverage, Footprint, Outline};
use super::keys::{
    ANGLE, AROUND, BITE, COLOUR as PAINT, COVER, HEIGHT, REACH, STRENGTH, THRESHOLD,
};
use super::limits::{MAX_HEIGHT, MAX_PULL_VX, MAX_RADIUS};
use super::options::BrushOptions;
use super::spec::{BrushSpec, BrushStroke};
use super::{BrushBall, BrushDirection, BrushId, BrushUse};
use crate::sculpture::Material;
use crate::sculpture::brick::local_coords;
use crate::sculpture::history::{Contents, SurfaceKind};
use crate::sculpture::region::ListedBricks;
use crate::sculpture::{Brick, ColourDepth, Grid, Rgb};
use crate::tools::symmetry::Symmetry;
use glam::{IVec3, UVec3, Vec3};

const COLOUR: Rgb = Rgb::new(200, 30, 40);

/// Returns a slab that fills y < 20 of a 64^3 grid.
fn slab() -> Grid {
    let mut grid = Grid::new(UVec3::splat(64), Vec3::ONE, 1 << 30).unwrap();
    grid.fill_bricks(|b| Brick::below([8, (20 - (b.y * 8).min(20)).min(8), 8]));
    grid
}

/// Returns a footprint that looks straight down on (32, 32), with one ray per voxel at the slab's surface.
fn from_above(radius: f32, outline: Outline) -> Footprint {
    let height = 100.0;
    Footprint {
        eye_vx: Vec3::new(32.5, 20.0 + height, 32.5),
        aim: Vec3::NEG_Y,
        across: Vec3::X / height,
        down: Vec3::Z / height,
        radius,
        outline,
        coverage: Coverage::Rays,
    }
}

fn used(brush: BrushId, footprint: Footprint, reach_vx: f32) -> BrushUse {
    BrushUse::under(brush, footprint).with(REACH, reach_vx)
}

fn contents(grid: &Grid, depth: ColourDepth) -> Contents {
    let material = Material::for_grid(grid, depth, Rgb::STONE);
    Contents { surface: SurfaceKind::Cubes, ..Contents::new(grid.clone(), material) }
}

/// Returns the change of a use in a grid, on a surface.
fn change(used: &BrushUse, grid: &Grid, surface: &Grid, depth: ColourDepth) -> BrushChange {
    assert_eq!(used.check(), Ok(()));
    let (contents, symmetry) = (contents(grid, depth), Symmetry::default());
    let images = symmetry.images(grid.dims(), grid.voxel_size());
    let site =
        Site { contents: &contents, surface, symmetry: &symmetry, images: &images, picture: None };
    BrushChange::of(used, &site).unwrap()
}

fn changed(used: &BrushUse, grid: &Grid) -> BrushChange {
    change(used, grid, grid, ColourDepth::Bits24)
}

fn painted(change: &BrushChange) -> Vec<IVec3> {
    change.paint.iter().flat_map(|(bricks, _)| voxels(bricks)).collect()
}

#[test]
fn every_brush_has_words_of_its_own() {
    let specs: Vec<&BrushSpec> = BrushId::ALL.iter().map(|brush| brush.spec()).collect();
    let texts =
        |of: fn(&BrushSpec) -> &str| -> HashSet<&str> { specs.iter().map(|s| of(s)).collect() };
    assert_eq!(texts(|spec| spec.name).len(), specs.len());
    assert_eq!(texts(|spec| spec.action).len(), specs.len());
    assert_eq!(texts(|spec| spec.label).len(), specs.len());
    assert_eq!(texts(|spec| spec.help).len(), specs.len());
    for spec in specs {
        let is_word = |text: &str| {
            !text.is_empty() && text.chars().all(|c| c.is_ascii_lowercase() || c == '-')
        };
        assert!(is_word(spec.name) && is_word(spec.action), "{spec:?}");
        assert!(spec.synonyms.split(' ').all(is_word), "{spec:?}");
        assert!(spec.help.starts_with(spec.label), "{spec:?}");
    }
}

/// Every brush can be used interactively with its default options, and each of those uses is a valid command.
#[test]
fn a_hand_can_use_every_brush_with_its_first_options() {
    let (at_vx, from_vx) = (Vec3::new(9.0, 8.0, 7.0), Vec3::new(8.0, 8.0, 7.0));
    for &brush in BrushId::ALL {
        let options = BrushOptions::first(brush);
        for (uses, sense) in [(0, 1.0), (1, -1.0), (7, 1.0), (1000, 1.0)] {
            let footprint = from_above(20.0, Outline::Round);
            let (normal, edges) = (Vec3::Y, Vec3::ONE);
            let place = match brush.spec().stroke {
                BrushStroke::Picture { .. } => {
                    DabPlace::Picture { footprint, colour: COLOUR, image: None, uses }
                }
                BrushStroke::Surface { .. } => {
                    DabPlace::Surface { at_vx, from_vx, normal, edges, sense }
                }
                BrushStroke::Held { .. } => {
                    let by_vx = Vec3::X * sense * uses as f32;
                    DabPlace::Held { start_vx: at_vx, by_vx, normal, right: Vec3::X, edges }
                }
            };
            let used = (brush.spec().dab)(&Dab { options: &options, place }).unwrap();
            assert_eq!(used.check(), Ok(()), "{brush:?}");
            assert!(used.brush() == brush || brush.spec().script.is_none(), "{brush:?}");
        }
    }
}

fn voxels(bricks: &ListedBricks) -> Vec<IVec3> {
    let mut all = Vec::new();
    for (b, mask) in bricks.bricks() {
        mask.for_each(|i| all.push((*b * 8 + UVec3::from(local_coords(i))).as_ivec3()));
    }
    all
}

#[test]
fn the_paintbrush_paints_what_is_seen_under_the_disc() {
    let grid = slab();
    let used = used(BrushId::Paint, from_above(6.0, Outline::Round), 3.0).with(PAINT, COLOUR);
    let change = changed(&used, &grid);
    let mut painted = painted(&change);
    painted.sort_by_key(|v| (v.z, v.x));
    let mut disc = Vec::new();
    for z in -6i32..=6 {
        for x in -6i32..=6 {
            if x * x + z * z <= 36 {
                disc.push(IVec3::new(32 + x, 19, 32 + z));
            }
        }
    }
    assert_eq!(painted, disc);
    assert!(change.add.bricks().is_empty() && change.remove.bricks().is_empty());
}

#[test]
fn cover_is_the_share_of_the_colour_that_a_pass_mixes_in() {
    let grid = slab();
    let grey = Rgb::new(100, 100, 100);
    for depth in [ColourDepth::Bits8, ColourDepth::Bits16, ColourDepth::Bits24] {
        let now = depth.quantise(grey);
        let mix = |cover: f32, eye: f32| {
            let mut footprint = from_above(20.0, Outline::Square);
            footprint.eye_vx.y += eye;
            let used = used(BrushId::Paint, footprint, 0.0).with(PAINT, COLOUR).with(COVER, cover);
            let change = change(&used, &grid, &grid, depth);
            let seen = painted(&change);
            assert_eq!(seen.len(), 41 * 41);
            let [(_, Paint::Mix(mix))] = &change.paint[..] else { panic!("no mixture") };
            let kept = |v: &IVec3| depth.quantise(mix.colour(v.as_uvec3(), now));
            seen.iter().map(kept).collect::<Vec<Rgb>>()
        };
        let mixed = mix(0.3, 0.0);
        for channel in 0..3 {
            let sum: f32 = mixed.iter().map(|c| f32::from(c.0[channel])).sum();
            let mean = sum / mixed.len() as f32;
            let (from, to) = (f32::from(now.0[channel]), f32::from(COLOUR.0[channel]));
            let wanted = from + 0.3 * (to - from);
            assert!((mean - wanted).abs() < 3.0, "{depth:?} {channel}: {mean} not {wanted}");
        }
        assert_eq!(mixed, mix(0.3, 0.0), "a pass replayed is the same pass");
        if depth == ColourDepth::Bits8 {
            assert_ne!(mixed, mix(0.3, 0.001), "another pass scatters otherwise");
        }
        assert!(mix(0.0, 0.0).iter().all(|c| *c == now));
        assert!(mix(1.0, 0.0).iter().all(|c| *c == depth.quantise(COLOUR)));
    }
}

#[test]
fn a_square_footprint_is_square() {
    let grid = slab();
    let used = used(BrushId::Paint, from_above(4.0, Outline::Square), 0.0).with(PAINT, COLOUR);
    let change = changed(&used, &grid);
    assert_eq!(painted(&change).len(), 9 * 9);
}

#[test]
fn the_devourer_bites_a_ball_or_a_cube() {
    let grid = slab();
    for (outline, expected) in [(Outline::Round, 33), (Outline::Square, 125)] {
        let one = from_above(0.0, Outline::Round);
        let used = used(BrushId::Devour, one, 2.0).with(BITE, outline);
        let bitten = voxels(&changed(&used, &grid).remove);
        assert_eq!(bitten.len(), expected);
        let centre = IVec3::new(32, 19, 32);
        assert!(bitten.iter().all(|v| (*v - centre).abs().max_element() <= 2));
    }
}

#[test]
fn rays_are_cast_on_the_surface_at_the_beginning_of_the_stroke() {
    let (surface, mut grid) = (slab(), slab());
    grid.set(IVec3::new(32, 19, 32), false);
    let used = used(BrushId::Devour, from_above(0.0, Outline::Round), 0.0);
    let at_beginning = voxels(&change(&used, &grid, &surface, ColourDepth::None).remove);
    let now = voxels(&change(&used, &grid, &grid, ColourDepth::None).remove);
    assert_eq!(at_beginning, [IVec3::new(32, 19, 32)]);
    assert_eq!(now, [IVec3::new(32, 18, 32)]);
}

#[test]
fn filters_leave_a_plane_alone() {
    let grid = slab();
    let used = |brush| used(brush, from_above(8.0, Outline::Round), 4.0);
    for used in [
        used(BrushId::Erode).with(THRESHOLD, 14),
        used(BrushId::Dilate).with(THRESHOLD, 10),
        used(BrushId::Grow).with(THRESHOLD, 12),
        used(BrushId::Smooth).with(AROUND, 2),
    ] {
        let change = changed(&used, &grid);
        let is_none = change.add.bricks().is_empty() && change.remove.bricks().is_empty();
        assert!(is_none && change.paint.is_empty(), "{used:?}");
    }
}

#[test]
fn smoothing_takes_a_single_voxel_and_fills_a_single_hole() {
    let mut grid = slab();
    grid.set(IVec3::new(32, 20, 32), true);
    grid.set(IVec3::new(36, 19, 32), false);
    let used = used(BrushId::Smooth, from_above(8.0, Outline::Round), 3.0).with(AROUND, 1);
    let change = changed(&used, &grid);
    assert_eq!(voxels(&change.remove), [IVec3::new(32, 20, 32)]);
    assert_eq!(voxels(&change.add), [IVec3::new(36, 19, 32)]);
}

#[test]
fn clay_is_a_mound_highest_in_the_middle() {
    let grid = slab();
    let used = used(BrushId::Clay, from_above(10.0, Outline::Round), 5.0).with(PAINT, COLOUR);
    let change = changed(&used, &grid);
    assert_eq!(change.new_clay, NewClay::Colour(COLOUR));
    let clay = voxels(&change.add);
    let height = |x: i32| clay.iter().filter(|v| v.x == x && v.z == 32).map(|v| v.y).max();
    assert_eq!(height(32), Some(24));
    assert!(height(38) < height(34) && height(41) < height(38));
    assert!(clay.iter().all(|v| (*v - IVec3::new(32, 19, 32)).abs().max_element() <= 12));
}

#[test]
fn a_brush_that_meets_nothing_does_nothing_and_nonsense_is_refused() {
    let grid = slab();
    let mut up = from_above(5.0, Outline::Round);
    up.aim = Vec3::Y;
    let bitten = changed(&used(BrushId::Devour, up, 3.0), &grid);
    assert!(bitten.remove.bricks().is_empty());
    let refused = |used: BrushUse| used.check().unwrap_err().to_string();
    let reach = "the reach of the brush must be from 0 to 64 (given: NaN)";
    assert_eq!(refused(used(BrushId::Devour, up, f32::NAN)), reach);
    let wide = from_above(1e9, Outline::Round);
    assert!(refused(used(BrushId::Devour, wide, 3.0)).contains("the radius"));
    let threshold = "the threshold of the brush must be from 1 to 26 (given: 99)";
    assert_eq!(refused(used(BrushId::Erode, up, 3.0).with(THRESHOLD, 99)), threshold);
    assert_eq!(refused(used(BrushId::Clay, up, 3.0)), "the colour of the brush is missing");
    let ball = BrushBall { centre_vx: Vec3::ONE, radius: 8.0, frame: BrushDirection::None };
    assert!(refused(BrushUse::in_ball(BrushId::Devour, ball)).contains("the place"));
    assert!(refused(BrushUse::in_ball(BrushId::Smear, ball)).contains("the place"));
}

#[test]
fn numbers_of_balls_out_of_range_are_refused() {
    let ball = |frame| BrushBall { centre_vx: Vec3::new(1.0, 2.0, 3.0), radius: 8.0, frame };
    let none = ball(BrushDirection::None);
    let up = ball(BrushDirection::Normal(Vec3::Y));
    let pull = |by_vx| BrushUse::in_ball(BrushId::Grab, ball(BrushDirection::Displacement(by_vx)));
    let used = BrushUse::in_ball;
    for good in [
        used(BrushId::Inflate, none).with(HEIGHT, -MAX_HEIGHT),
        used(BrushId::Flatten, up).with(STRENGTH, 1.0),
        used(BrushId::Draw, up).with(HEIGHT, MAX_HEIGHT),
        used(BrushId::Pinch, up).with(STRENGTH, -1.0),
        used(BrushId::Twist, up).with(ANGLE, -360.0),
        pull(Vec3::splat(MAX_PULL_VX)),
    ] {
        assert_eq!(good.check(), Ok(()));
    }
    let inflate = |ball| used(BrushId::Inflate, ball).with(HEIGHT, 1.0);
    let along =
        |normal| used(BrushId::Draw, ball(BrushDirection::Normal(normal))).with(HEIGHT, 1.0);
    for (bad, field) in [
        (inflate(BrushBall { radius: 0.0, ..none }), "radius"),
        (inflate(BrushBall { radius: 1e-6, ..none }), "radius"),
        (inflate(BrushBall { radius: f32::NAN, ..none }), "radius"),
        (inflate(BrushBall { radius: MAX_RADIUS * 1.01, ..none }), "radius"),
        (inflate(BrushBall { centre_vx: Vec3::INFINITY, ..none }), "middle"),
        (inflate(BrushBall { centre_vx: Vec3::splat(1e30), ..none }), "middle"),
        (inflate(none).with(HEIGHT, f32::NAN), "height"),
        (inflate(none).with(HEIGHT, -MAX_HEIGHT * 1.01), "height"),
        (used(BrushId::Inflate, none), "height"),
        (inflate(up), "place"),
        (along(Vec3::ZERO), "normal"),
        (along(Vec3::NAN), "normal"),
        (along(Vec3::Y).with(HEIGHT, 16.5), "height"),
        (used(BrushId::Fill, up).with(STRENGTH, 1.1), "strength"),
        (used(BrushId::Scrape, up).with(STRENGTH, f32::NAN), "strength"),
        (used(BrushId::Pinch, up).with(STRENGTH, 1.5), "strength"),
        (used(BrushId::Pinch, up), "strength"),
        (used(BrushId::Twist, up).with(ANGLE, 361.0), "angle"),
        (pull(Vec3::NAN), "pull"),
        (pull(Vec3::X * (MAX_PULL_VX + 1.0)), "pull"),
    ] {
        assert_eq!(bad.check().unwrap_err().field, field, "{bad:?}");
    }
}

//! Tests what regions say of boxes of voxels: against their rows and masks, against the definitions of solids, also at
//! negative coordinates, and that boxes a voxel away from a surface are decided.

use std::sync::Arc;

use fearless_simd::{Level, Simd, dispatch};
use glam::{DVec3, I64Vec3, IVec3, Quat, UVec3, Vec2, Vec3};
use proptest::prelude::*;

use super::drawn::region::PlacedDrawnSolid;
use super::drawn::{ControlPoint, DrawnSolid, Extrusion, HalfSpace, Lathe, Ring, SolidPose, Tube};
use super::solid::tests::{axis_turns, rotation};
use super::solid::{PlacedSolid, Primitive, Solid};
use super::symmetry::{MirrorPlane, Parity, Radial, Symmetry, SymmetryTransform};
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::sculpture::edit_scope::{EditScope, ScopedRegion};
use crate::sculpture::grid::MAX_AXIS_VX;
use crate::sculpture::region::{BoxCoverage, Everywhere, Region, VoxelBox};
use crate::sculpture::selection::Selection;
use crate::sculpture::{Brick, Grid};

const EDGES: [i32; 3] = [8, 64, 512];

fn cube(min: IVec3, edge: i32) -> VoxelBox {
    VoxelBox { min, max: min + edge }
}

/// Checks that a region covers all or none of the bricks of `bounds` that lie within `grid`, as edits see them, if it
/// says so. Returns what it says.
fn check_masks(
    region: &impl Region,
    bounds: VoxelBox,
    grid: VoxelBox,
) -> Result<BoxCoverage, TestCaseError> {
    let coverage = region.coverage(bounds);
    if coverage != BoxCoverage::Part {
        let inside = bounds.intersect(grid);
        dispatch!(Level::new(), simd => check_rows(simd, region, inside, coverage))?;
    }
    Ok(coverage)
}

fn check_rows(
    simd: impl Simd,
    region: &impl Region,
    inside: VoxelBox,
    coverage: BoxCoverage,
) -> Result<(), TestCaseError> {
    if inside.is_empty() {
        return Ok(());
    }
    let edge = BRICK_EDGE_VX;
    let (low, high) = (inside.min.as_uvec3(), inside.max.as_uvec3());
    // Of the bricks at the border of a grid, a part.
    let valid = |b: UVec3| {
        let limit = (high - b * edge).min(UVec3::splat(edge)).to_array();
        Brick::below(limit)
    };
    let mut row = Default::default();
    for z in low.z / edge..high.z.div_ceil(edge) {
        for y in low.y / edge..high.y.div_ceil(edge) {
            let reach = region.cut_row(simd, y * edge, z * edge, &mut row);
            for x in low.x / edge..high.x.div_ceil(edge) {
                let mask = match () {
                    _ if !reach.touched.contains(&x) => Brick::EMPTY,
                    _ if reach.whole.contains(&x) => Brick::FULL,
                    () => region.mask(simd, &row, &reach, x),
                };
                let b = UVec3::new(x, y, z);
                let expected = match coverage {
                    BoxCoverage::All => valid(b),
                    _ => Brick::EMPTY,
                };
                prop_assert_eq!(mask.and(&valid(b)), expected, "brick {} is not {:?}", b, coverage);
            }
        }
    }
    Ok(())
}

/// Compares what a region says of `bounds` with its definition, at voxels throughout the box and at its border.
fn check_definition(
    region: &impl Region,
    bounds: VoxelBox,
    contains: impl Fn(IVec3) -> bool,
) -> Result<(), TestCaseError> {
    let coverage = region.coverage(bounds);
    let (first, last) = (bounds.min.as_i64vec3(), bounds.max.as_i64vec3() - 1);
    for i in 0..if coverage == BoxCoverage::Part { 0 } else { 729 } {
        let v = first + (last - first) * I64Vec3::new(i % 9, i / 9 % 9, i / 81) / 8;
        let v = v.as_ivec3();
        prop_assert_eq!(contains(v), coverage == BoxCoverage::All, "{} of {:?}", v, bounds);
    }
    Ok(())
}

/// Numbers from 0 to 1 that choose an aligned cube near a solid.
#[derive(Clone, Copy, Debug)]
struct CubeChoice {
    edge: i32,
    share: Vec3,
}

impl CubeChoice {
    /// Returns the cube: within `bounds`, or beside it by up to its edge.
    fn near(self, bounds: VoxelBox) -> VoxelBox {
        let furthest = IVec3::splat(20_000);
        let (min, max) =
            (bounds.min.clamp(-furthest, furthest), bounds.max.clamp(-furthest, furthest));
        let (min, max) = ((min - self.edge).as_vec3(), max.as_vec3());
        let at = (min + (max - min) * self.share).floor().as_ivec3();
        cube(at.div_euclid(IVec3::splat(self.edge)) * self.edge, self.edge)
    }
}

fn cubes() -> impl Strategy<Value = Vec<CubeChoice>> {
    let choice = (prop::sample::select(&EDGES[..]), prop::array::uniform3(0f32..=1.0));
    let choice = choice.prop_map(|(edge, share)| CubeChoice { edge, share: share.into() });
    prop::collection::vec(choice, 24)
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -100f32..700.0,
        2 => (-8i16..80).prop_map(|v| f32::from(v) * 8.0),
        1 => (-20i16..1000).prop_map(|v| f32::from(v) / 2.0),
        1 => -16384f32..16384.0,
    ]
}

fn half() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => 0.5f32..100.0,
        3 => 50f32..600.0,
        2 => (1u8..60).prop_map(|v| f32::from(v) * 4.0),
        1 => 1000f32..30_000.0,
    ]
}

fn place() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(coordinate()).prop_map(Vec3::from)
}

fn voxel_size() -> impl Strategy<Value = Vec3> {
    prop_oneof![
        3 => Just(Vec3::ONE),
        1 => prop::array::uniform3(0.2f32..3.0).prop_map(Vec3::from),
        1 => prop::array::uniform3(1u8..4).prop_map(|v| Vec3::from(v.map(f32::from))),
    ]
}

/// Generates an image of a random symmetry: mirror planes of the axes, one in any position, rotations.
fn image(size: impl Strategy<Value = Vec3>) -> impl Strategy<Value = SymmetryTransform> {
    let direction = || {
        prop_oneof![
            prop::sample::select(vec![Vec3::X, Vec3::Y, Vec3::Z]),
            prop::array::uniform3(-1f32..1.0).prop_map(Vec3::from),
        ]
    };
    let plane = (place(), direction()).prop_map(|(at_vx, normal)| MirrorPlane { at_vx, normal });
    let radial = (place(), direction(), 2u32..8).prop_map(|(at_vx, axis, count)| Radial {
        at_vx,
        axis,
        count,
    });
    let axes = prop::array::uniform3(prop::option::of(prop::sample::select(&Parity::ALL[..])));
    let symmetry = (axes, prop::option::of(plane), prop::option::of(radial))
        .prop_map(|(axes, plane, radial)| Symmetry { axes, plane, radial })
        .prop_filter("a valid symmetry", |symmetry| symmetry.check().is_ok());
    (symmetry, size, any::<prop::sample::Index>()).prop_map(|(symmetry, size, index)| {
        let images = symmetry.images(UVec3::new(520, 320, 400), size);
        *index.get(&images)
    })
}

fn any_image(size: impl Strategy<Value = Vec3>) -> impl Strategy<Value = SymmetryTransform> {
    prop_oneof![2 => Just(SymmetryTransform::of_planes([None; 3])), 1 => image(size)]
}

fn primitive() -> impl Strategy<Value = Primitive> {
    let halves = prop_oneof![
        half().prop_map(Vec3::splat),
        prop::array::uniform3(half()).prop_map(Vec3::from),
    ];
    (prop::sample::select(&Solid::ALL[..]), place(), halves, rotation()).prop_map(
        |(solid, centre_vx, half, rotation)| Primitive { solid, centre_vx, half, rotation },
    )
}

fn displacement() -> impl Strategy<Value = Option<Vec3>> {
    let axis =
        prop_oneof![2 => -500f32..500.0, 1 => Just(0.0), 1 => -3f32..3.0, 1 => -9000f32..9000.0];
    prop::option::of(prop::array::uniform3(axis).prop_map(Vec3::from))
}

/// Generates drawn solids of all kinds; some of their outlines cross themselves or are lines.
fn drawn_solid() -> impl Strategy<Value = DrawnSolid> {
    let pose = || {
        let turn = prop_oneof![rotation(), prop::sample::select(axis_turns())];
        (place(), turn).prop_map(|(at_vx, rotation)| SolidPose { at_vx, rotation })
    };
    let normal = prop_oneof![
        prop::array::uniform3(-1f32..1.0),
        prop::sample::select(vec![[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 5.0]]),
    ]
    .prop_filter("a direction", |n| n.iter().any(|v| v.abs() > 1e-3));
    let half_space = (place(), normal)
        .prop_map(|(at_vx, normal)| HalfSpace { at_vx, normal: normal.into() }.into());
    let ring = (pose(), half(), half())
        .prop_map(|(pose, radius, tube)| Ring { pose, radius, tube }.into());
    let point = (place(), half()).prop_map(|(at_vx, radius)| ControlPoint { at_vx, radius });
    let tube = prop::collection::vec(point, 1..5)
        .prop_map(|points| Tube { control_points: points.into() }.into());
    let profile = prop::collection::vec((0f32..500.0, -400f32..400.0), 2..7);
    let lathe = (pose(), profile).prop_map(|(pose, profile)| {
        Lathe { pose, profile: profile.into_iter().map(Vec2::from).collect() }.into()
    });
    let side =
        || prop_oneof![3 => -500f32..500.0, 1 => (-8i8..8).prop_map(|v| f32::from(v) * 32.0)];
    let outline = prop::collection::vec((side(), side()), 2..7)
        .prop_map(|points| points.into_iter().map(Vec2::from).collect::<Arc<[Vec2]>>());
    let extrusion = (pose(), prop::collection::vec(outline, 1..3), half()).prop_map(
        |(pose, outlines, depth)| Extrusion { pose, outlines: outlines.into(), depth }.into(),
    );
    let example = (prop::sample::select(&DrawnSolid::ALL[..]), pose(), half())
        .prop_map(|(spec, pose, size)| (spec.example)(pose, size));
    prop_oneof![half_space, ring, tube, lathe, extrusion, example]
        .prop_filter("a valid solid", |drawn| drawn.check().is_ok())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn solids_cover_boxes_as_they_say(
        primitive in primitive(),
        displacement in displacement(),
        size in voxel_size(),
        image in any_image(voxel_size()),
        cubes in cubes(),
    ) {
        let to_vx = displacement.map(|displacement| primitive.centre_vx + displacement);
        let placed = primitive.image_in_grid(to_vx, size, &image);
        let grid = cube(IVec3::ZERO, MAX_AXIS_VX as i32);
        for choice in cubes {
            let bounds = choice.near(placed.bounds_vx());
            check_masks(&placed, bounds, grid)?;
            check_definition(&placed, bounds, |v| placed.contains_voxel(v))?;
        }
    }

    #[test]
    fn drawn_solids_cover_boxes_as_they_say(
        drawn in drawn_solid(),
        dims in prop::array::uniform3(40u32..520),
        size in voxel_size(),
        image in any_image(voxel_size()),
        cubes in cubes(),
    ) {
        let grid = Grid::new(dims.into(), size, 1 << 30).unwrap();
        let placed = PlacedDrawnSolid::new(&drawn, &grid, image);
        let all = VoxelBox::of_grid(&grid);
        for choice in cubes {
            check_masks(&placed, choice.near(all), all)?;
            let anywhere = choice.near(VoxelBox { min: all.min - 9000, max: all.max + 9000 });
            for bounds in [choice.near(all), anywhere] {
                check_definition(&placed, bounds, |v| placed.contains_voxel(v))?;
            }
        }
    }

    #[test]
    fn scopes_cover_boxes_as_they_say(
        primitive in primitive(),
        dims in prop::array::uniform3(9u32..200),
        boxes in prop::collection::vec((any_box(), any::<bool>()), 1..6),
        protected in prop::collection::vec(any_box(), 0..4),
        cubes in cubes(),
    ) {
        let grid = Grid::new(dims.into(), Vec3::ONE, 1 << 30).unwrap();
        let all = VoxelBox::of_grid(&grid);
        let mut mask = grid.emptied();
        mask.fill_bricks(|b| {
            let brick = |bounds: &VoxelBox| {
                let mut row = Default::default();
                dispatch!(Level::new(), simd => {
                    let reach = bounds.cut_row(simd, b.y * 8, b.z * 8, &mut row);
                    bounds.mask(simd, &row, &reach, b.x)
                })
            };
            let covered = protected.iter().map(brick).fold(Brick::EMPTY, |a, b| a.or(&b));
            covered.and(&grid.valid_mask(b))
        });
        let mut selection = Selection::new(dims.into());
        for (bounds, adds) in boxes {
            selection.set_marker(bounds).unwrap();
            selection.push(adds);
        }
        let placed = primitive.in_grid(Vec3::ONE);
        for choice in cubes {
            let bounds = choice.near(all);
            check_masks(selection.stack(), bounds, all)?;
            check_definition(selection.stack(), bounds, |v| selection.stack().contains(v))?;
            for stack in [None, Some(selection.stack())] {
                for mask in [None, Some(&mask)] {
                    let scope = EditScope { stack, mask };
                    check_masks(&ScopedRegion { region: &placed, scope }, bounds, all)?;
                    let of_all = check_masks(&ScopedRegion { region: &Everywhere, scope }, bounds, all)?;
                    let is_limited = stack.is_some() || mask.is_some();
                    prop_assert!(is_limited || of_all == BoxCoverage::All);
                }
            }
        }
    }
}

/// Generates boxes, some of them along bricks.
fn any_box() -> impl Strategy<Value = VoxelBox> {
    let corners = (prop::array::uniform3(-9i32..200), prop::array::uniform3(1i32..220));
    (corners, any::<bool>()).prop_map(|((min, size), aligned)| {
        let (min, size) = (IVec3::from(min), IVec3::from(size));
        match aligned {
            true => VoxelBox { min: min / 64 * 64, max: min / 64 * 64 + (size / 64 + 1) * 64 },
            false => VoxelBox { min, max: min + size },
        }
    })
}

/// A cube beside a convex body, as numbers that are independent of it.
#[derive(Clone, Copy, Debug)]
struct Beside {
    edge: i32,
    /// From the body to the cube, of length 1.
    normal: DVec3,
    /// Where the cube lies across the normal.
    across: DVec3,
    /// Distance along the normal, in voxels.
    gap: f64,
}

fn beside() -> impl Strategy<Value = Beside> {
    let normal = prop_oneof![
        4 => prop::array::uniform3(-1.0f64..1.0),
        1 => prop::array::uniform3(prop::sample::select(vec![-1.0, 0.0, 1.0])),
    ]
    .prop_map(DVec3::from)
    .prop_filter("a direction", |n| n.length() > 0.1);
    let edge = prop_oneof![prop::sample::select(vec![8, 64, 512, 4096, 8192]), 8i32..8192];
    let across = prop::array::uniform3(-1.0f64..1.0);
    (edge, normal, across, 2.0f64..5.0).prop_map(|(edge, normal, across, gap)| Beside {
        edge,
        normal: normal.normalize(),
        across: across.into(),
        gap,
    })
}

impl Beside {
    /// Returns a cube at least one voxel beside a body of about `size` voxels, whose furthest point along the normal is
    /// `furthest`.
    fn of(self, furthest: DVec3, size: f64) -> VoxelBox {
        let Beside { edge, normal, across, gap } = self;
        let half = 0.5 * f64::from(edge);
        let across = across.reject_from(normal) * (half + size);
        let reach = normal.abs().element_sum() * half;
        let middle = furthest + normal * (gap + reach) + across;
        cube((middle - half).round().as_ivec3(), edge)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    /// A cube beside a solid, by at least a voxel, is known to lie there; if a cube that is larger by a voxel on each
    /// side has all its corners inside, so is that. Both at negative coordinates, too.
    #[test]
    fn a_voxel_from_the_surface_of_a_solid_is_enough(
        primitive in primitive(),
        displacement in displacement(),
        beside in beside(),
        image in any_image(Just(Vec3::ONE)),
        inner in prop::array::uniform3(-1.0f64..1.0),
    ) {
        let to_vx = displacement.map(|displacement| primitive.centre_vx + displacement);
        let placed = primitive.image_in_grid(to_vx, Vec3::ONE, &image);
        let size = f64::from(primitive.half.max_element());
        let outside = beside.of(placed.furthest_vx(beside.normal), size);
        prop_assert_eq!(placed.coverage(outside), BoxCoverage::None, "{:?} of {:?}", outside, placed);

        if primitive.solid != Solid::Torus {
            let middle = image.point_exactly(primitive.centre_vx.as_dvec3()) + DVec3::from(inner) * size;
            let inside = cube((middle - 0.5 * f64::from(beside.edge)).as_ivec3(), beside.edge);
            check_inside(&placed, inside, |v| placed.contains_voxel(v))?;
        }
    }

    #[test]
    fn a_voxel_from_the_surface_of_a_convex_drawn_solid_is_enough(
        ends in prop::array::uniform2((place(), half())),
        pose in (place(), rotation()),
        sides in prop::array::uniform3(half()),
        beside in beside(),
        image in any_image(Just(Vec3::ONE)),
        inner in prop::array::uniform3(-1.0f64..1.0),
    ) {
        let grid = Grid::new(UVec3::splat(16), Vec3::ONE, 1 << 30).unwrap();
        let place = |drawn: DrawnSolid| PlacedDrawnSolid::new(&drawn, &grid, image);
        let normal = beside.normal;
        // The direction that the image maps to the normal.
        let original = (image.origin_of(normal * 1e3) - image.origin_of(DVec3::ZERO)).normalize();

        // A tube of two points, a tube of one.
        let balls = ends.map(|(at_vx, radius)| ControlPoint { at_vx, radius });
        prop_assume!(balls[0].at_vx != balls[1].at_vx);
        for balls in [&balls[..], &balls[..1]] {
            let tube = place(Tube { control_points: balls.into() }.into());
            let reach = |ball: &ControlPoint| {
                ball.at_vx.as_dvec3() + original * f64::from(ball.radius)
            };
            let furthest = balls.iter().map(reach).max_by(|a, b| a.dot(original).total_cmp(&b.dot(original)));
            let outside = beside.of(image.point_exactly(furthest.unwrap()), 100.0);
            prop_assert_eq!(tube.coverage(outside), BoxCoverage::None, "{:?} of {:?}", outside, tube);
            let radius = f64::from(balls[0].radius);
            let middle = image.point_exactly(balls[0].at_vx.as_dvec3()) + DVec3::from(inner) * radius;
            let inside = cube((middle - 0.5 * f64::from(beside.edge)).as_ivec3(), beside.edge);
            check_inside(&tube, inside, |v| tube.contains_voxel(v))?;
        }

        // A half space: the cube may lie on either side.
        let (at_vx, rotation) = pose;
        let space = |normal: DVec3| place(HalfSpace { at_vx, normal: normal.as_vec3() }.into());
        let on_plane = beside.of(image.point_exactly(at_vx.as_dvec3()), 100.0);
        prop_assert_eq!(space(original).coverage(on_plane), BoxCoverage::All);
        prop_assert_eq!(space(-original).coverage(on_plane), BoxCoverage::None);

        // The extrusion of a rectangle.
        let [x, y, depth] = sides;
        let corners = [[-x, -y], [x, -y], [x, y], [-x, y]].map(Vec2::from);
        let outlines = Arc::new([corners.into()]);
        let pose = SolidPose { at_vx, rotation };
        let bar = place(Extrusion { pose, outlines, depth }.into());
        let size = f64::from(x.max(y).max(depth));
        let middle = image.point_exactly(at_vx.as_dvec3()) + DVec3::from(inner) * size;
        let inside = cube((middle - 0.5 * f64::from(beside.edge)).as_ivec3(), beside.edge);
        check_inside(&bar, inside, |v| bar.contains_voxel(v))?;
    }
}

/// Checks that a convex region covers a cube if it covers the corners of one that is larger by a voxel on each side.
fn check_inside(
    region: &impl Region,
    inside: VoxelBox,
    contains: impl Fn(IVec3) -> bool,
) -> Result<(), TestCaseError> {
    let (low, high) = (inside.min - 1, inside.max);
    let corner = |i: i32| low + (high - low) * IVec3::new(i & 1, i >> 1 & 1, i >> 2);
    if (0..8).map(corner).all(contains) {
        prop_assert_eq!(region.coverage(inside), BoxCoverage::All, "{:?}", inside);
    }
    Ok(())
}

fn ball(centre: f32, radius: f32) -> PlacedSolid {
    solid(Solid::Ellipsoid, centre, radius)
}

fn solid(solid: Solid, centre: f32, half: f32) -> PlacedSolid {
    let primitive = Primitive {
        solid,
        centre_vx: Vec3::splat(centre),
        half: Vec3::splat(half),
        rotation: Quat::IDENTITY,
    };
    primitive.in_grid(Vec3::ONE)
}

fn cube_at(min: i32, edge: i32) -> VoxelBox {
    cube(IVec3::splat(min), edge)
}

#[test]
fn cubes_in_and_beside_a_ball_are_decided() {
    use BoxCoverage::{All, None, Part};
    // A cube of edge e fits into a ball of radius r if e times the root of 3/4 is at most r.
    for (edge, radius) in [(8, 8.0), (64, 57.0), (512, 445.0), (4096, 3549.0)] {
        let middle = edge as f32 * 0.5;
        let round = ball(middle, radius);
        assert_eq!(round.coverage(cube_at(0, edge)), All);
        assert_eq!(ball(middle, 0.7 * radius).coverage(cube_at(0, edge)), Part);
        assert_eq!(round.coverage(cube_at(edge + 2, edge)), None, "at a corner");
        let beside = |by: i32| cube(IVec3::new(edge / 2 + by, 0, 0), edge);
        assert_eq!(round.coverage(beside(radius as i32)), None, "at a face");
        assert_eq!(round.coverage(beside(radius as i32 - 2)), Part);
        assert_eq!(round.coverage(cube_at(-edge / 4, edge)), Part);
        let away = ball(middle - 3.0 * edge as f32, radius);
        assert_eq!(away.coverage(cube_at(-3 * edge, edge)), All, "at negative coordinates");
        assert_eq!(away.coverage(cube_at(0, edge)), None);
    }
}

#[test]
fn a_cuboid_along_the_grid_covers_cubes_that_touch_its_faces() {
    use BoxCoverage::{All, None, Part};
    let block = solid(Solid::Cuboid, 64.0, 64.0);
    for edge in [8, 64, 128] {
        assert_eq!(block.coverage(cube_at(0, edge)), All);
        assert_eq!(block.coverage(cube_at(128 - edge, edge)), All);
        assert_eq!(block.coverage(cube_at(128, edge)), None);
        assert_eq!(block.coverage(cube_at(-edge, edge)), None);
        assert_eq!(block.coverage(cube_at(-1, edge)), Part);
        assert_eq!(block.coverage(cube_at(129 - edge, edge)), Part);
    }
    // Faces through the centres of voxels, which they include.
    let block = solid(Solid::Cuboid, 16.5, 8.0);
    assert_eq!(block.coverage(cube_at(8, 17)), All);
    assert_eq!(block.coverage(cube_at(8, 18)), Part);
    assert_eq!(block.coverage(cube_at(25, 8)), None);
}

#[test]
fn both_sides_of_a_half_space_are_decided_and_mirrored() {
    use BoxCoverage::{All, None, Part};
    let grid = Grid::new(UVec3::splat(128), Vec3::ONE, 1 << 30).unwrap();
    let space: DrawnSolid = HalfSpace { at_vx: Vec3::splat(16.0), normal: Vec3::X }.into();
    let mirror = |plane| SymmetryTransform::of_planes([plane, Option::None, Option::None]);
    let placed = PlacedDrawnSolid::new(&space, &grid, mirror(Option::None));
    let mirrored = PlacedDrawnSolid::new(&space, &grid, mirror(Some(64.0)));
    for edge in [8, 64, 4096] {
        let at = |x: i32| cube(IVec3::new(x, -edge / 2, 0), edge);
        for (x, coverage) in [(16, All), (15, Part), (16 - edge, None), (17 - edge, Part)] {
            assert_eq!(placed.coverage(at(x)), coverage, "{x} {edge}");
            assert_eq!(mirrored.coverage(at(128 - x - edge)), coverage, "{x} {edge} mirrored");
        }
    }
    let everything = VoxelBox { min: IVec3::MIN, max: IVec3::MAX };
    assert_eq!(placed.coverage(everything), Part);
    assert_eq!(placed.coverage(VoxelBox { min: IVec3::MIN, max: IVec3::ZERO }), None);
    assert_eq!(placed.coverage(VoxelBox { min: IVec3::splat(16), max: IVec3::MAX }), All);
    assert_eq!(placed.coverage(VoxelBox { min: IVec3::ONE, max: IVec3::ONE }), None);
}

#[test]
fn cubes_in_the_tube_and_in_the_hole_of_a_ring_are_decided() {
    use BoxCoverage::{All, None, Part};
    let grid = Grid::new(UVec3::splat(16), Vec3::ONE, 1 << 30).unwrap();
    let pose = SolidPose { at_vx: Vec3::splat(256.0), rotation: Quat::IDENTITY };
    let ring = Ring { pose, radius: 192.0, tube: 48.0 };
    let identity = SymmetryTransform::of_planes([Option::None; 3]);
    let drawn = PlacedDrawnSolid::new(&ring.into(), &grid, identity);
    let profile = [[144.0, -48.0], [240.0, -48.0], [240.0, 48.0], [144.0, 48.0], [144.0, -48.0]];
    // Its ends are joined to the axis along one line, which bounds nothing.
    let lathe = Lathe { pose, profile: profile.map(Vec2::from).into() };
    let turned = PlacedDrawnSolid::new(&lathe.into(), &grid, identity);
    let torus = Primitive {
        solid: Solid::Torus,
        centre_vx: Vec3::splat(256.0),
        half: Vec3::new(240.0, 48.0, 240.0),
        rotation: Quat::IDENTITY,
    };
    let torus = torus.in_grid(Vec3::ONE);
    let at = |x: i32, y: i32, edge: i32| cube(IVec3::new(x, y, 256 - edge / 2), edge);
    for (bounds, coverage) in [
        (at(432, 240, 32), All),
        (at(240, 240, 32), None),
        (at(400, 224, 64), Part),
        (at(224, 320, 64), None),
        (at(0, 0, 512), Part),
    ] {
        assert_eq!(drawn.coverage(bounds), coverage, "{bounds:?}");
        assert_eq!(torus.coverage(bounds), coverage, "{bounds:?}");
    }
    // Upright, cubes are decided up to the surface.
    for (bounds, coverage) in [
        (at(416, 224, 64), All),
        (at(130, 130, 252), Part),
        (at(498, 224, 64), None),
        (at(304, 305, 64), None),
    ] {
        assert_eq!(drawn.coverage(bounds), coverage, "{bounds:?}");
        assert_eq!(turned.coverage(bounds), coverage, "{bounds:?}");
    }
    assert_eq!(turned.coverage(at(402, 209, 90)), All);
    assert_eq!(turned.coverage(at(150, 150, 212)), Part);
    assert_eq!(turned.coverage(at(190, 210, 90)), None);
}

#[test]
fn extreme_boxes_and_solids_are_not_wrong() {
    let everything = VoxelBox { min: IVec3::MIN, max: IVec3::MAX };
    let empty = VoxelBox { min: IVec3::MAX, max: IVec3::MIN };
    for kind in Solid::ALL {
        for half in [f32::MIN_POSITIVE, 1e-3, 1.0, 1e6, 1e30, f32::MAX] {
            for centre in [0.0, -1e6, 1e30, f32::MAX] {
                let placed = solid(kind, centre, half);
                assert_eq!(placed.coverage(empty), BoxCoverage::None);
                for bounds in [everything, cube_at(0, 8), cube_at(-16384, 4096), cube_at(0, 1)] {
                    check_definition(&placed, bounds, |v| placed.contains_voxel(v)).unwrap();
                }
            }
        }
    }
}

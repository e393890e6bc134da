//! Polish: flattens and smooths the surface in one pass.

use super::BrushUse;
use super::change::{BrushChange, Site};
use super::falloff::Falloff;
use super::kernel::rays::Filtered;
use super::kernel::{filter, offset};
use super::keys::{FALLOFF, RADIUS, STEADY, STRENGTH};
use super::spec::{BrushSpec, BrushStroke, ContactKind, Keeps, Script, SurfaceNormal};
use crate::refusal::InvalidValue;

/// See [`BrushSpec`].
pub const SPEC: BrushSpec = BrushSpec {
    name: "polish",
    action: "polish",
    label: "Polish",
    help: "Polish: flattens and smooths the surface in one pass",
    effect: "Moves the surface in a ball to the mean plane around the press, and then smooths it: at half strength, one use removes grains and pits of one voxel.",
    keeps: Keeps::of("bumps go and pits fill, regardless of their volumes", Keeps::AROUND, "made"),
    synonyms: "buff sand burnish deform",
    options: &[
        RADIUS.first(40.0).param,
        STRENGTH
            .first(0.5)
            .help("How far the surface moves to the plane, and how much it is smoothed")
            .param,
        STEADY.param,
        FALLOFF.first(Falloff::Flat).param,
    ],
    stroke: BrushStroke::Surface { normal: SurfaceNormal::OfPress { on_plane: true } },
    script: Script::in_ball(ContactKind::BallWithNormal, &[STRENGTH.param, FALLOFF.param], apply),
    ..BrushSpec::DEFORM
};

/// Reach of the majority filter, in voxels.
const AROUND_VX: u32 = 2;
/// Exponent applied to the strength for the filter. At half strength, one use removes a grain or pit of one voxel in a
/// plane.
const EVENNESS: f32 = 0.25;

fn apply(used: &BrushUse, site: &Site) -> Result<BrushChange, InvalidValue> {
    let evenness = used.get(STRENGTH).powf(EVENNESS);
    Ok(offset::to_plane_then(used, site, AROUND_VX, |near| {
        let (add, remove) = filter::majority(&near.solid, &near.may, AROUND_VX, evenness);
        Filtered { add: Some(add), remove: Some(remove) }
    }))
}

#[cfg(test)]
mod tests {
    use glam::{IVec3, UVec3, Vec3};

    use crate::command::NewSculpture;
    use crate::document::{Document, Limits};
    use crate::sculpture::{ColourDepth, Rgb};

    /// Greatest height of the ground in voxels.
    const GROUND_VX: i32 = 24;
    /// The centre of the brush, on the surface of a ground.
    const MIDDLE: i32 = 32;
    const RADIUS_VX: i32 = 20;

    /// Returns a ground that fills the lower part of 64^3 voxels.
    fn ground() -> Document {
        let new = NewSculpture {
            dims: UVec3::splat(64),
            voxel_size: Vec3::ONE,
            colour_depth: ColourDepth::None,
            base: Rgb::STONE,
            solid: true,
            room_vx: 0,
            grows: false,
        };
        let mut document = Document::new(&new, Limits::default()).unwrap();
        run(&mut document, &format!("subtract cuboid at=32,{},32 half=40,20,40", GROUND_VX + 20));
        document
    }

    fn run(document: &mut Document, line: &str) {
        document.apply(&line.parse().unwrap()).unwrap();
    }

    fn polish(document: &mut Document, strength: f32) {
        let at = format!("at={MIDDLE},{GROUND_VX},{MIDDLE} radius={RADIUS_VX} normal=0,1,0");
        run(document, &format!("deform polish {at} strength={strength} falloff=flat"));
    }

    /// Returns the height of the ground in voxels at a position.
    fn height(document: &Document, x: i32, z: i32) -> i32 {
        (0..64).filter(|&y| document.grid().get(IVec3::new(x, y, z))).count() as i32
    }

    /// Returns the columns within a distance of the centre.
    fn columns(within_vx: i32) -> impl Iterator<Item = (i32, i32)> {
        let all = (0..64).flat_map(|z| (0..64).map(move |x| (x, z)));
        all.filter(move |(x, z)| {
            let [x, z] = [2 * (x - MIDDLE) + 1, 2 * (z - MIDDLE) + 1];
            x * x + z * z <= 4 * within_vx * within_vx
        })
    }

    /// Returns a ground with alternating grains and pits of one voxel, every three voxels.
    fn rough() -> Document {
        let mut document = ground();
        for (i, (x, z)) in columns(30).filter(|(x, z)| x % 3 == 0 && z % 3 == 0).enumerate() {
            let (edit, y) = [("add", GROUND_VX), ("subtract", GROUND_VX - 1)][i % 2];
            let at = [x, y, z].map(|v| format!("{}", v as f32 + 0.5)).join(",");
            run(&mut document, &format!("{edit} cuboid at={at} half=0.5"));
        }
        document
    }

    fn off_level(document: &Document, within_vx: i32) -> usize {
        columns(within_vx).filter(|&(x, z)| height(document, x, z) != GROUND_VX).count()
    }

    #[test]
    fn grains_and_pits_go_in_one_press_at_half_strength_and_stay_outside() {
        let mut document = rough();
        let (inside, around) = (off_level(&document, RADIUS_VX * 3 / 4), off_level(&document, 30));
        assert!(inside > 60 && around > inside + 150, "{inside} {around}");
        let before = document.grid().clone();
        polish(&mut document, 0.5);
        assert_eq!(off_level(&document, RADIUS_VX * 3 / 4), 0);
        for (x, z) in columns(30) {
            let [dx, dz] = [x - MIDDLE, z - MIDDLE];
            if dx * dx + dz * dz > (RADIUS_VX + 2).pow(2) {
                let same = |y| {
                    let v = IVec3::new(x, y, z);
                    document.grid().get(v) == before.get(v)
                };
                assert!((0..64).all(same), "{x} {z}");
            }
        }
    }

    #[test]
    fn a_broad_hill_sinks_with_every_press() {
        let mut document = ground();
        run(&mut document, &format!("add ellipsoid at=32,{GROUND_VX},32 half=14,8,14"));
        let mut heights = vec![height(&document, MIDDLE, MIDDLE) - GROUND_VX];
        for _ in 0..12 {
            polish(&mut document, 0.5);
            heights.push(height(&document, MIDDLE, MIDDLE) - GROUND_VX);
        }
        assert!((3..=5).contains(&heights[1]), "half of the way: {heights:?}");
        assert!(heights.is_sorted_by(|a, b| a >= b), "{heights:?}");
        assert!(*heights.last().unwrap() <= 1, "{heights:?}");
    }

    #[test]
    fn without_strength_nothing_changes() {
        let mut document = rough();
        let before = document.grid().clone();
        polish(&mut document, 0.0);
        assert!(*document.grid() == before);
    }
}

//! Benchmarks of single uses of all brushes, of masks and of symmetry, like those of a person: on the face of a
//! coloured block of 512³ voxels with a hollow, seen from half a block away.

use std::path::Path;

use glam::{IVec3, Quat, Vec3};

use super::edits::{EditReport, block, subtract, take_back, timed};
use crate::command::{Command, MaskArea, MaskChange, PatchRule};
use crate::document::CommandError;
use crate::sculpture::{ColourDepth, Limits, Rgb};
use crate::tools::brush::dab::{Dab, DabPlace};
use crate::tools::brush::footprint::{Coverage, Footprint, Outline};
use crate::tools::brush::keys::{AROUND, COLOUR, RADIUS, REACH};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::{BrushGroup, BrushStroke};
use crate::tools::brush::{BrushId, BrushSurface, BrushUse};
use crate::tools::solid::{Primitive, Solid};
use crate::tools::symmetry::{MirrorPlane, Radial, Symmetry};
use crate::tools::texture::Texture;

/// The middle of the face.
const TOP_VX: Vec3 = Vec3::new(256.0, 512.0, 256.0);
/// The radius of the hollow there, which gives filters and masks something to do.
const HOLLOW_VX: f32 = 64.0;
/// A name for the stencil.
const PICTURE: &str = "stripes";
const PAINT: Rgb = Rgb::new(190, 30, 60);

/// Returns the measured uses.
pub fn uses(runs: usize, limits: Limits) -> Result<Vec<EditReport>, CommandError> {
    let mut document = block(ColourDepth::Bits24, limits)?;
    if let Some(stripes) = stripes() {
        document.learn_picture(Path::new(PICTURE), stripes);
    }
    document.apply(&cut(TOP_VX, HOLLOW_VX))?;
    let mut reports = Vec::new();
    let brushes = BrushId::ALL.iter().map(|brush| (brush.spec().name, used(*brush)));
    let further = further_brushes().map(|(name, used)| (name, Some(used)));
    for (name, used) in brushes.chain(further) {
        let Some(used) = used else { continue };
        let on_mask = used.brush().spec().group == BrushGroup::Mask;
        if on_mask {
            document.apply(&mask_ball(HOLLOW_VX))?;
        }
        let name = format!("{name}, radius {RADIUS_VX}");
        reports.extend(timed(&mut document, &name, &Command::Brush(used), runs)?);
        if on_mask {
            take_back(&mut document)?;
        }
    }
    for (name, what) in areas() {
        let command = Command::Mask(MaskChange::Put { adds: true, what });
        reports.extend(timed(&mut document, &format!("mask of {name}"), &command, runs)?);
    }
    document.apply(&mask_ball(128.0))?;
    for (name, change) in [
        ("mask grown by 4", MaskChange::Grow(4)),
        ("mask shrunk by 4", MaskChange::Shrink(4)),
        ("mask evened within 2", MaskChange::Smooth(2)),
        ("mask inverted", MaskChange::Invert),
        ("mask cleared", MaskChange::Clear),
    ] {
        reports.extend(timed(&mut document, name, &Command::Mask(change), runs)?);
    }
    let aside = cut(TOP_VX + Vec3::X * 128.0, 64.0);
    reports.extend(timed(&mut document, "sphere of 64 over the edge of a mask", &aside, runs)?);
    take_back(&mut document)?;
    let plane = MirrorPlane { at_vx: TOP_VX, normal: Vec3::new(1.0, 0.1, 0.2) };
    let radial = Radial { at_vx: TOP_VX, axis: Vec3::Y, count: 8 };
    for (name, symmetry) in [
        ("sphere of 64 and its image", Symmetry { plane: Some(plane), ..Symmetry::default() }),
        ("sphere of 64, eightfold", Symmetry { radial: Some(radial), ..Symmetry::default() }),
    ] {
        document.apply(&Command::Symmetry(symmetry))?;
        reports.extend(timed(&mut document, name, &aside, runs)?);
    }
    Ok(reports)
}

/// The radius of the brushes, in voxels.
const RADIUS_VX: f32 = 48.0;

/// Returns a use of a brush with its default options: under an outline over the hollow, or in a ball at its rim.
fn used(brush: BrushId) -> Option<BrushUse> {
    let spec = brush.spec();
    let options = BrushOptions::first(brush).with(RADIUS, RADIUS_VX);
    let rim = TOP_VX + Vec3::X * HOLLOW_VX;
    let (normal, edges) = (Vec3::new(0.2, 1.0, 0.1).normalize(), Vec3::ONE);
    let place = match spec.stroke {
        BrushStroke::Picture { .. } => {
            DabPlace::Picture { footprint: from_above(), colour: PAINT, image: None, uses: 0 }
        }
        BrushStroke::Surface { .. } => {
            let from_vx = rim - Vec3::X * spec.spacing * RADIUS_VX;
            DabPlace::Surface { at_vx: rim, from_vx, normal, edges, sense: 1.0 }
        }
        BrushStroke::Held { .. } => {
            let by_vx = Vec3::new(8.0, -8.0, 2.0);
            DabPlace::Held { start_vx: rim, by_vx, normal, right: Vec3::X, edges }
        }
    };
    // Without an open stroke, the surface of its beginning is the present one.
    (spec.dab)(&Dab { options: &options, place }).map(|used| used.on(BrushSurface::Now))
}

/// Returns a footprint with one voxel per ray.
fn from_above() -> Footprint {
    Footprint {
        eye_vx: TOP_VX + Vec3::Y * 256.0,
        aim: Vec3::NEG_Y * 256.0,
        across: Vec3::X,
        down: Vec3::Z,
        radius: RADIUS_VX,
        outline: Outline::Round,
        coverage: Coverage::Visible,
    }
}

/// Returns further uses: brushes in other places, with an image, and smoothing as in the first versions.
fn further_brushes() -> [(&'static str, BrushUse); 4] {
    let footprint = from_above();
    let painted = |footprint| BrushUse::under(BrushId::Paint, footprint).with(COLOUR, PAINT);
    // As at 1024^3 with the whole view, and from ten degrees above the surface.
    let wide = Footprint { across: Vec3::X * 2.0, down: Vec3::Z * 2.0, ..footprint };
    let direction = Vec3::new(0.985, -0.174, 0.0);
    let aslant = Footprint {
        eye_vx: TOP_VX - direction * 1024.0,
        aim: direction * 1024.0,
        across: Vec3::Z,
        down: direction.cross(Vec3::Z),
        ..footprint
    };
    let mut stencil = BrushUse::under(BrushId::Paint, footprint);
    stencil.picture = Some(PICTURE.into());
    let majority = BrushUse::under(BrushId::Smooth, footprint).with(REACH, 2.0).with(AROUND, 2);
    [
        ("paint, two voxels a pixel", painted(wide)),
        ("paint, seen aslant", painted(aslant)),
        ("stencil", stencil),
        ("smooth by the majority", majority),
    ]
}

fn areas() -> Vec<(&'static str, MaskArea)> {
    let at = IVec3::new(20, 511, 20);
    vec![
        ("cavities", MaskArea::Cavities { reach_vx: 4, depth_vx: 2 }),
        ("a flat patch", MaskArea::Patch { at, by: PatchRule::Flat(20.0), depth_vx: 2 }),
        ("a patch of one colour", MaskArea::Patch { at, by: PatchRule::Colour(0.1), depth_vx: 2 }),
        ("a piece", MaskArea::Piece { at }),
    ]
}

fn cut(centre_vx: Vec3, radius: f32) -> Command {
    subtract(Solid::Ellipsoid, centre_vx, Vec3::splat(radius), Quat::IDENTITY)
}

fn mask_ball(radius: f32) -> Command {
    let primitive = Primitive {
        solid: Solid::Ellipsoid,
        centre_vx: TOP_VX,
        half: Vec3::splat(radius),
        rotation: Quat::IDENTITY,
    };
    let what = MaskArea::Solid { primitive, to_vx: None };
    Command::Mask(MaskChange::Put { adds: true, what })
}

/// Returns stripes of 64 by 64 pixels.
fn stripes() -> Option<Texture> {
    let pixel = |i: u32| match i % 64 / 8 % 2 {
        0 => Rgb::new(240, 240, 230),
        _ => Rgb::new(40, 60, 90),
    };
    Texture::new(64, (0..64 * 64).map(pixel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_use_does_something() {
        let reports = uses(1, Limits::default()).unwrap();
        assert_eq!(reports.len(), BrushId::ALL.len() + 16);
        for report in &reports {
            assert!(report.voxels > 0, "{report:?}");
        }
        // A ball over another one counts only the voxels that it removes, not those already gone or masked.
        let voxels = |name: &str| reports.iter().find(|r| r.name.starts_with(name)).unwrap().voxels;
        assert!(voxels("sphere of 64 over") < voxels("sphere of 64 and") / 2);
        // Two of them do not overlap; eight overlap slightly.
        let (two, eight) = (voxels("sphere of 64 and"), voxels("sphere of 64, eightfold"));
        assert!(2 * eight > 5 * two && eight < 4 * two, "{two} {eight}");
    }
}

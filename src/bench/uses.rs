//! Benchmarks of single uses of brushes, masks and symmetry, as a person makes them: on the face of a coloured block of
//! 512³ voxels, seen from half a block before it.

use std::path::Path;

use glam::{Quat, UVec3, Vec3};

use super::edits::{EditReport, block, subtract, take_back, timed};
use crate::command::{Command, MaskArea, MaskChange, PatchRule};
use crate::document::CommandError;
use crate::sculpture::{ColourDepth, Limits, Rgb};
use crate::tools::brush::footprint::{Coverage, Footprint, Outline};
use crate::tools::brush::keys::{AROUND, COLOUR, COVER, REACH, STRENGTH, THRESHOLD};
use crate::tools::brush::{BrushId, BrushUse};
use crate::tools::solid::{Primitive, Solid};
use crate::tools::symmetry::{MirrorPlane, Radial, Symmetry};
use crate::tools::texture::Texture;

/// The middle of the face.
const TOP_VX: Vec3 = Vec3::new(256.0, 512.0, 256.0);
/// A name for the stencil.
const PICTURE: &str = "stripes";
const PAINT: Rgb = Rgb::new(190, 30, 60);

/// The measured uses. A face with a hollow gives filters and masks something to do.
pub fn uses(runs: usize, limits: Limits) -> Result<Vec<EditReport>, CommandError> {
    let mut document = block(ColourDepth::Bits24, limits)?;
    if let Some(stripes) = stripes() {
        document.learn_picture(Path::new(PICTURE), stripes);
    }
    document.apply(&cut(TOP_VX, 64.0))?;
    let mut reports = Vec::new();
    for (name, command) in brushes() {
        reports.extend(timed(&mut document, &format!("{name}, radius 48"), &command, runs)?);
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

/// Brushes of 48 rays around the middle, a voxel apart.
fn brushes() -> Vec<(&'static str, Command)> {
    let footprint = Footprint {
        eye_vx: TOP_VX + Vec3::Y * 256.0,
        aim: Vec3::NEG_Y * 256.0,
        across: Vec3::X,
        down: Vec3::Z,
        radius: 48.0,
        outline: Outline::Round,
        coverage: Coverage::Visible,
    };
    let under = |footprint, brush| BrushUse::under(brush, footprint);
    let used = |brush, reach_vx: f32| under(footprint, brush).with(REACH, reach_vx);
    let painted = |footprint| {
        let used = under(footprint, BrushId::Paint).with(REACH, 0.0);
        Command::Brush(used.with(COLOUR, PAINT).with(COVER, 0.5))
    };
    // As at 1024^3 in whole view, and from ten degrees above the surface.
    let wide = Footprint { across: Vec3::X * 2.0, down: Vec3::Z * 2.0, ..footprint };
    let way = Vec3::new(0.985, -0.174, 0.0);
    let aslant = Footprint {
        eye_vx: TOP_VX - way * 1024.0,
        aim: way * 1024.0,
        across: Vec3::Z,
        down: way.cross(Vec3::Z),
        ..footprint
    };
    let mut stencil = under(footprint, BrushId::Paint);
    stencil.picture = Some(PICTURE.into());
    vec![
        ("brush", painted(footprint)),
        ("brush, two voxels a pixel", painted(wide)),
        ("brush, seen aslant", painted(aslant)),
        ("stencil", Command::Brush(stencil)),
        ("devourer of depth 4", Command::Brush(used(BrushId::Devour, 4.0))),
        ("clay of height 4", Command::Brush(used(BrushId::Clay, 4.0).with(COLOUR, PAINT))),
        ("erosion", Command::Brush(used(BrushId::Erode, 1.0).with(THRESHOLD, 14))),
        ("dilation", Command::Brush(used(BrushId::Dilate, 1.0).with(THRESHOLD, 12))),
        ("growth", Command::Brush(used(BrushId::Grow, 1.0).with(THRESHOLD, 14))),
        ("smooth by the majority", Command::Brush(used(BrushId::Smooth, 2.0).with(AROUND, 2))),
        ("smooth", Command::Brush(used(BrushId::Smooth, 0.0).with(STRENGTH, 0.5))),
        ("mask brush of depth 4", Command::Brush(used(BrushId::Mask, 4.0))),
    ]
}

fn areas() -> Vec<(&'static str, MaskArea)> {
    let at = UVec3::new(20, 511, 20);
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

/// 64 by 64 pixels.
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
        assert_eq!(reports.len(), 24);
        for report in &reports {
            assert!(report.voxels > 0, "{report:?}");
        }
        // A ball over another one counts only the voxels that it takes away, not those already gone or masked.
        let voxels = |name: &str| reports.iter().find(|r| r.name.starts_with(name)).unwrap().voxels;
        assert!(voxels("sphere of 64 over") < voxels("sphere of 64 and") / 2);
        // Two of them do not overlap, eight a little.
        let (two, eight) = (voxels("sphere of 64 and"), voxels("sphere of 64, eightfold"));
        assert!(2 * eight > 5 * two && eight < 4 * two, "{two} {eight}");
    }
}

//! Applies solids as tools: solids in a box, drawn solids, and images on them, each with its mirror images.
//!
//! Takes the target and a solid; returns counts of changes. Memory is checked before the first change.

use std::path::Path;

use glam::Vec3;

use super::CommandError;
use super::edit_target::EditTarget;
use super::pictures::LoadedPictures;
use crate::sculpture::edit::{EditOp, EditStats};
use crate::sculpture::to_paint::PaintedWith;
use crate::tools::drawn::DrawnSolid;
use crate::tools::drawn::region::PlacedDrawnSolid;
use crate::tools::solid::{PlacedSolid, Primitive, check_sweep_end};
use crate::tools::symmetry::SymmetryTransform;

/// Edits the voxels inside a solid, or inside the volume that it sweeps to `to_vx`.
pub(super) fn construct(
    target: &mut EditTarget,
    op: EditOp,
    primitive: &Primitive,
    to_vx: Option<Vec3>,
) -> Result<EditStats, CommandError> {
    primitive.check().and_then(|()| check_sweep_end(to_vx))?;
    target.require_colours_for(op)?;
    let regions = images_of(target, primitive, to_vx, PaintedWith::Edit(op))?;
    let mut stats = EditStats::default();
    regions.iter().for_each(|(_, region)| stats += target.edit(region, op));
    Ok(stats)
}

/// Edits the voxels inside a drawn solid.
pub(super) fn draw(
    target: &mut EditTarget,
    op: EditOp,
    drawn: &DrawnSolid,
) -> Result<EditStats, CommandError> {
    drawn.check()?;
    target.require_colours_for(op)?;
    let images = target.images();
    let regions: Vec<_> =
        images.iter().map(|image| PlacedDrawnSolid::new(drawn, target.grid(), *image)).collect();
    let painted = PaintedWith::Edit(op);
    target.check_memory(regions.iter(), painted)?;
    let mut stats = EditStats::default();
    regions.iter().for_each(|region| stats += target.edit(region, op));
    Ok(stats)
}

/// Colours the voxels inside a solid with an image. Mirror images show the image mirrored.
pub(super) fn texture(
    target: &mut EditTarget,
    primitive: &Primitive,
    pictures: &LoadedPictures,
    picture: &Path,
) -> Result<EditStats, CommandError> {
    primitive.check()?;
    target.require_colours()?;
    let texture = pictures.get(picture)?;
    let placed = primitive.in_grid(target.grid().voxel_size());
    let image_point = primitive.solid.spec().image_point;
    let mut stats = EditStats::default();
    for (image, region) in
        images_of(target, primitive, None, PaintedWith::AnyColours { keeps_base: false })?
    {
        stats += target.paint(&region, |v, _| {
            let p = placed.tool_point(image.origin_of(v.as_dvec3() + 0.5).as_vec3());
            texture.sample(image_point(p))
        });
    }
    Ok(stats)
}

/// Returns a solid and its mirror images, placed in the grid; an error if memory does not suffice for the change
/// `painted`.
fn images_of(
    target: &EditTarget,
    primitive: &Primitive,
    to_vx: Option<Vec3>,
    painted: PaintedWith,
) -> Result<Vec<(SymmetryTransform, PlacedSolid)>, CommandError> {
    let voxel_size = target.grid().voxel_size();
    let placed =
        |image: SymmetryTransform| (image, primitive.image_in_grid(to_vx, voxel_size, &image));
    let images = target.images();
    let solids: Vec<_> = images.into_iter().map(placed).collect();
    target.check_memory(solids.iter().map(|(_, region)| region), painted)?;
    Ok(solids)
}

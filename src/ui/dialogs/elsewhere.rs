//! Lists terms of other programs with their counterparts here: an option of a panel, an action with another name, or
//! else the nearest feature.
//!
//! A table for the palette. Searches are compared in British spelling and lower case.

use crate::input::{Action, DrawKind, ToolMode};
use crate::tools::brush::BrushId;
use crate::ui::widgets::filter::Filter;
use crate::ui::widgets::spot::Spot;

/// Added to the rank if only part of a name is typed.
const PART: u32 = 3;

/// Where a search leads.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SearchTarget {
    /// The panel opens and the option blinks.
    Option(Spot),
    Do(Action),
}

/// A feature with the names under which people look for it.
#[derive(PartialEq, Eq, Debug)]
pub struct Elsewhere {
    /// Separated by commas.
    pub names: &'static str,
    /// Describes the feature here, or why there is none and what is nearest.
    pub text: &'static str,
    pub target: SearchTarget,
}

impl Elsewhere {
    /// Returns how far the typed words are from its names, as [`Filter::rank`] does. Part of a name, such as the
    /// `smooth` of `smooth stroke`, more likely means something else.
    pub fn rank(&self, filter: &Filter) -> Option<u32> {
        let rank = |name: &str| {
            let is_part = name.split(' ').count() > filter.len();
            Some(filter.rank(name, &[], &[])? + if is_part { PART } else { 0 })
        };
        self.names.split(", ").filter_map(rank).min()
    }
}

const fn option(names: &'static str, text: &'static str, spot: Spot) -> Elsewhere {
    Elsewhere { names, text, target: SearchTarget::Option(spot) }
}

const fn action(names: &'static str, text: &'static str, action: Action) -> Elsewhere {
    Elsewhere { names, text, target: SearchTarget::Do(action) }
}

/// All features with other names here.
pub static ELSEWHERE: &[Elsewhere] = &[
    option("array, pattern", "Array: repeat the last operation with an offset", Spot::Array),
    option(
        "alpha, stencil, stamp image, texture brush",
        "Stencil: the brush paints an image, or a colour through it",
        Spot::Stencil,
    ),
    option(
        "pressure, pen pressure, tablet, stylus, wacom, pen tilt",
        "Pen pressure and tilt: how they affect the brush",
        Spot::Pressure,
    ),
    option(
        "steady, lazy mouse, lazy brush, stabiliser, stroke stabiliser, smooth stroke",
        "Steady strokes: the pointer pulls the brush on a rope",
        Spot::Steady,
    ),
    option(
        "matcap, material, shader, clay look",
        "Look of the surface: true colours, clay, stone or a matcap",
        Spot::Looks,
    ),
    option(
        "ao, ambient occlusion, cavity shading",
        "Ambient occlusion: darkens crevices",
        Spot::Occlusion,
    ),
    option(
        "solid view, viewport shading, shaded view, voxel view",
        "Render modes, in the bar along the top",
        Spot::RenderMode,
    ),
    option(
        "symmetry options, symmetry centre, symmetry plane",
        "Symmetry: mirror planes, their positions, and rotation about an axis",
        Spot::Symmetry,
    ),
    action(
        "boolean, union, difference, subtract solid",
        "Boolean: solids add or cut; this sets them to cut",
        Action::Mode(ToolMode::Subtract),
    ),
    action(
        "merge, merge files, combine, append",
        "No merging of files: copy in one, open the other, paste",
        Action::Copy,
    ),
    action(
        "extract, separate, split off",
        "Extract: copy the marker's box and paste it",
        Action::Copy,
    ),
    action(
        "transform, gizmo, transform gizmo, move object, manipulator",
        "Move, rotate and mirror a part: put the marker around it",
        Action::Marker,
    ),
    action(
        "measure, ruler, distance, dimensions",
        "Measure: the marker shows the size of its box",
        Action::Marker,
    ),
    action(
        "crop, crop grid",
        "No cropping: copy the marker's box, paste it in a new grid",
        Action::Marker,
    ),
    action(
        "enlarge grid, resize grid, canvas, canvas size, grid size",
        "The grid keeps its size: copy all, and paste it in a larger new one",
        Action::New,
    ),
    action(
        "remesh, remesher, dyntopo, dynamic topology, topology",
        "No remeshing: voxels have no topology; Smooth evens out the surface",
        Action::Brush(BrushId::Smooth),
    ),
    action(
        "resample, resolution, subdivide, subdivision, multires, multiresolution",
        "One resolution: choose the size in voxels for a new sculpture",
        Action::New,
    ),
    action(
        "decimate, reduce, simplify, polygon count",
        "Meshes are simplified when they are exported",
        Action::Export,
    ),
    action("voxelise, voxeliser", "Meshes become voxels when they are opened", Action::Open),
    action("layers, layer", "No layers: masks and selected boxes keep parts apart", Action::Masks),
    action(
        "isolate, local view, hide part, visibility",
        "Nothing is hidden: a mask keeps tools off the rest",
        Action::Masks,
    ),
    action(
        "wireframe, polyframe, wire",
        "No wireframe: voxels have no edges to show; see the grid outline",
        Action::ToggleBounds,
    ),
    action(
        "xray, x-ray, see through, transparency, section view",
        "Nothing is transparent: cut it open with a plane, then undo",
        Action::Draw(DrawKind::Plane),
    ),
    action(
        "pivot, origin, orbit centre, focus, focus selected, recentre",
        "The view rotates about the sculpture's middle: frame it",
        Action::ResetView,
    ),
    action(
        "clay strips, clay buildup, build up",
        "Clay raises strips under the brush",
        Action::Brush(BrushId::Clay),
    ),
    action(
        "thickness, wall thickness, thin walls",
        "Thickness: the print check finds thin walls",
        Action::PrintCheck,
    ),
    action(
        "hdri, environment map, sky, world",
        "No HDRI: sun and sky light final pictures",
        Action::FinalPicture,
    ),
    action("scale, size", "Scale: enlarge the tool by one step", Action::Grow),
    action(
        "standard brush, draw brush",
        "Draw raises the surface along its normal",
        Action::Brush(BrushId::Draw),
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::action::TriggerKind;
    use crate::ui::widgets::filter::british;

    #[test]
    fn names_are_as_searches_are_brought_into_and_stand_once() {
        let mut names: Vec<&str> = ELSEWHERE.iter().flat_map(|it| it.names.split(", ")).collect();
        assert!(names.iter().all(|name| *name == british(name)), "{names:?}");
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }

    #[test]
    fn targets_of_foreign_terms_need_no_mouse() {
        for it in ELSEWHERE {
            let action = match it.target {
                SearchTarget::Do(action) => Some(action),
                SearchTarget::Option(spot) => spot.needs(),
            };
            assert!(
                action.is_none_or(|action| action.help().kind == TriggerKind::Tap),
                "{}",
                it.names
            );
        }
    }
}

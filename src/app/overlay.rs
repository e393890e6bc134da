//! The contents of the overlay and their look: the tool with its outline and its mirror images, the
//! red line from the grid's centre, the edges of the grid, marker and selection, mirror planes.

use std::f32::consts::TAU;

use glam::{Quat, UVec3, Vec2, Vec3};

use super::symmetry_lines::{self, MIRROR};
use super::tool_outline::{SEGMENTS, box_edges, outline_of};
use crate::document::Document;
use crate::editor::draw::Sketch;
use crate::editor::tool::{ToolKind, ToolState};
use crate::input::ToolMode;
use crate::render::overlay::{OverlayLine, ToolPreview};
use crate::sculpture::Rgb;
use crate::sculpture::region::VoxelBox;
use crate::surface::IndexMap;
use crate::tools::brush::footprint::Outline;
use crate::tools::brush::keys::{OUTLINE, RADIUS, STEADY};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::OutlineColour;
use crate::tools::solid::{Primitive, Solid};
use crate::ui::{Theme, ViewState};

const CUT: Rgb = Rgb::new(0xff, 0x6b, 0x57);
const MARKER: Rgb = Rgb::new(0x4a, 0xc8, 0xf0);
const SELECTED: Rgb = Rgb::new(0x58, 0xd0, 0x78);
const PASTE: Rgb = Rgb::new(0xf4, 0xc8, 0x40);
/// Most images of a tool that are outlined.
const MOST_IMAGES: usize = 15;
/// The colour of the mask.
const MASK: Rgb = Rgb::new(0x5f, 0x8d, 0xd3);
const RED: Rgb = Rgb::new(0xf0, 0x30, 0x28);

/// The values that the overlay is drawn from.
pub struct OverlayScene<'a> {
    pub tool: &'a ToolState,
    pub document: &'a Document,
    pub view: &'a ViewState,
    pub theme: Theme,
    /// The picture as it was last shown, with the pointer in it.
    pub seen: Option<&'a IndexMap>,
    pub pointer: Option<Vec2>,
    /// A stroke is in progress.
    pub stroking: bool,
    /// The lines of the solid being drawn.
    pub sketch: Option<Sketch>,
    /// The plane or line to which a drag confines the marker.
    pub marker_guide: Vec<[Vec3; 2]>,
    /// Distance from the eye plane to the point under the pointer, in world units.
    pub depth: f32,
}

/// Returns the tool as a shell, in the colour that it applies, or red if it cuts; the marker as a box.
pub fn preview(scene: &OverlayScene) -> Option<ToolPreview> {
    let voxel_size = scene.document.grid().voxel_size();
    match scene.tool.kind {
        _ if !scene.view.tool || scene.tool.next_press.is_some() => None,
        ToolKind::Draw(_) => None,
        ToolKind::Brush(brush) if brush.spec().is_in_picture() => None,
        ToolKind::Brush(brush) => Some(ToolPreview {
            primitive: scene.tool.ball(brush),
            voxel_size,
            colour: MIRROR,
            opacity: [0.16, 0.08],
        }),
        ToolKind::Solid => Some(ToolPreview {
            primitive: scene.tool.primitive(),
            voxel_size,
            colour: colour_of(scene.tool),
            opacity: [0.38, 0.12],
        }),
        ToolKind::Marker => {
            let VoxelBox { min, max } = scene.document.selection().marker();
            let stretch = voxel_size / voxel_size.min_element();
            let (min, max) = (min.as_vec3(), max.as_vec3());
            let primitive = Primitive {
                solid: Solid::Cuboid,
                centre_vx: (min + max) * 0.5,
                half: (max - min) * 0.5 * stretch,
                rotation: Quat::IDENTITY,
            };
            Some(ToolPreview { primitive, voxel_size, colour: MARKER, opacity: [0.16, 0.06] })
        }
    }
}

/// Returns the lines of a picture that the person wants to see.
pub fn lines(scene: &OverlayScene) -> Vec<OverlayLine> {
    let &OverlayScene { tool, document, view, .. } = scene;
    let (grid, selection) = (document.grid(), document.selection());
    let mut lines = Vec::new();
    if view.bounds {
        let colour = match scene.theme {
            Theme::Dark => Rgb::new(0x9a, 0xa4, 0xb0),
            Theme::Light => Rgb::new(0x60, 0x68, 0x70),
        };
        let edge = |from, to| OverlayLine { from, to, colour, width_px: 1.2, opacity: [0.6, 0.0] };
        lines.extend(box_edges(Vec3::ZERO, grid.dims().as_vec3()).map(|(a, b)| edge(a, b)));
    }
    lines.extend(symmetry_lines::lines(document));
    let marking = tool.kind == ToolKind::Marker;
    if selection.limits() || marking {
        for selected in selection.boxes() {
            let colour = if selected.adds { SELECTED } else { CUT };
            lines.extend(frame(selected.bounds, colour, [0.9, 0.35]));
        }
    }
    // A press that does something else shows no tool.
    if !view.tool || tool.next_press.is_some() {
        return lines;
    }
    if view.line && tool.kind == ToolKind::Solid {
        lines.push(OverlayLine {
            from: centre_vx(grid.dims()),
            to: tool.centre_vx,
            colour: RED,
            width_px: 1.8,
            opacity: [0.95, 0.0],
        });
    }
    let outline = |colour| {
        move |(from, to)| OverlayLine { from, to, colour, width_px: 1.4, opacity: [0.9, 0.3] }
    };
    match tool.kind {
        ToolKind::Brush(brush) if brush.spec().is_in_picture() => {
            let options = tool.brushes.of(brush);
            let colour = tint(brush.spec().tint, tool.colour);
            lines.extend(footprint_edges(scene, options).into_iter().map(outline(colour)));
        }
        ToolKind::Solid | ToolKind::Brush(_) => {
            let (shape, colour) = match tool.kind {
                ToolKind::Brush(brush) => (tool.ball(brush), tint(brush.spec().tint, tool.colour)),
                _ => (tool.primitive(), colour_of(tool)),
            };
            lines.extend(outline_of(&shape, grid).into_iter().map(outline(colour)));
            lines.extend(rope(scene).map(outline(colour)));
            for image in document.images().iter().skip(1).take(MOST_IMAGES) {
                let mirrored = outline_of(&shape.image(image), grid);
                lines.extend(mirrored.into_iter().map(outline(MIRROR)));
            }
        }
        ToolKind::Draw(_) => lines.extend(sketched(scene)),
        ToolKind::Marker => lines.extend(marker_lines(scene)),
    }
    lines
}

/// Returns the edges of a box.
fn frame(bounds: VoxelBox, colour: Rgb, opacity: [f32; 2]) -> impl Iterator<Item = OverlayLine> {
    let edges = box_edges(bounds.min.as_vec3(), bounds.max.as_vec3());
    edges.map(move |(from, to)| OverlayLine { from, to, colour, width_px: 1.4, opacity })
}

/// Returns the marker with its guide, and the box into which the clipboard would be pasted.
fn marker_lines(scene: &OverlayScene) -> Vec<OverlayLine> {
    let marker = scene.document.selection().marker();
    let mut lines: Vec<OverlayLine> = frame(marker, MARKER, [1.0, 0.5]).collect();
    lines.extend(scene.marker_guide.iter().map(|[from, to]| OverlayLine {
        from: *from,
        to: *to,
        colour: MARKER,
        width_px: 1.0,
        opacity: [0.45, 0.15],
    }));
    if let Some(clip) = scene.document.clip() {
        let bounds = clip.bounds(marker.min, scene.tool.paste_orientation);
        lines.extend(frame(bounds, PASTE, [0.9, 0.4]));
    }
    lines
}

/// Returns the lines of the unfinished drawing, with its mirror images.
fn sketched(scene: &OverlayScene) -> Vec<OverlayLine> {
    let Some(sketch) = &scene.sketch else { return Vec::new() };
    let colour = colour_in(scene.tool, sketch.mode);
    let own = |opacity, width_px| {
        move |[from, to]: &[Vec3; 2]| OverlayLine {
            from: *from,
            to: *to,
            colour,
            width_px,
            opacity,
        }
    };
    let drawn = sketch.lines.iter().map(own([1.0, 0.7], 2.0));
    let mut lines: Vec<OverlayLine> =
        drawn.chain(sketch.faint.iter().map(own([0.6, 0.4], 1.4))).collect();
    let document = scene.document;
    for image in document.images().iter().skip(1).take(MOST_IMAGES) {
        lines.extend(sketch.lines.iter().map(|[from, to]| OverlayLine {
            from: image.point(*from),
            to: image.point(*to),
            colour: MIRROR,
            width_px: 1.4,
            opacity: [0.9, 0.3],
        }));
    }
    lines
}

/// Returns the rope by which the pointer pulls a brush.
fn rope(scene: &OverlayScene) -> Option<(Vec3, Vec3)> {
    let tool = scene.tool;
    let (map, at) = scene.seen.zip(scene.pointer)?;
    let end = map.rays.origin + map.rays.direction_at(at.x, at.y) * scene.depth;
    let is_steady = tool.brush_options().is_some_and(|options| options.get(STEADY) > 0.0);
    (scene.stroking && is_steady).then_some((tool.centre_vx, end))
}

/// Returns the colour of a brush's outline. `own`: the chosen colour.
fn tint(tint: OutlineColour, own: Rgb) -> Rgb {
    match tint {
        OutlineColour::Cut => CUT,
        OutlineColour::Neutral => MIRROR,
        OutlineColour::Mask => MASK,
        OutlineColour::Colour => own,
    }
}

/// Returns the rim of a brush's footprint, projected at the depth of the point under the pointer.
fn footprint_edges(scene: &OverlayScene, options: &BrushOptions) -> Vec<(Vec3, Vec3)> {
    let (Some(map), Some(at)) = (scene.seen, scene.pointer) else { return Vec::new() };
    let radius_px = scene.tool.brushes.radius_px(options.get(RADIUS), None);
    let point = |offset: Vec2| {
        let at = at + offset * radius_px;
        map.rays.origin + map.rays.direction_at(at.x, at.y) * scene.depth
    };
    let corners: Vec<Vec3> = match options.get(OUTLINE) {
        Outline::Round => (0..SEGMENTS)
            .map(|i| point(Vec2::from_angle(TAU * i as f32 / SEGMENTS as f32)))
            .collect(),
        Outline::Square => [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| point(Vec2::new(x, y)))
            .to_vec(),
    };
    let next = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(next.copied()).collect()
}

fn centre_vx(dims: UVec3) -> Vec3 {
    dims.as_vec3() * 0.5
}

fn colour_of(tool: &ToolState) -> Rgb {
    colour_in(tool, tool.mode)
}

fn colour_in(tool: &ToolState, mode: ToolMode) -> Rgb {
    match mode {
        ToolMode::Add | ToolMode::Recolour => tool.colour,
        ToolMode::Subtract => CUT,
        ToolMode::Protect | ToolMode::Release => MASK,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Command;
    use crate::command::NewSculpture;
    use crate::config::Config;
    use crate::document::Limits;
    use crate::input::DrawKind;
    use crate::sculpture::ColourDepth;
    use crate::tools::brush::BrushId;
    use crate::tools::symmetry::{Parity, Symmetry};
    use crate::ui::UiState;

    #[test]
    fn parts_of_grid_and_line_behind_the_sculpture_are_not_drawn() {
        let document = document();
        let state = UiState::new(&Config::default().ui_options());
        let tool = ToolState::new(&document.contents().frame);
        let scene = OverlayScene {
            tool: &tool,
            document: &document,
            view: &state.view,
            theme: Theme::Light,
            seen: None,
            pointer: None,
            stroking: false,
            sketch: None,
            marker_guide: Vec::new(),
            depth: 1.0,
        };
        let lines = lines(&scene);
        let hidden = lines.iter().filter(|line| line.opacity[1] == 0.0).count();
        assert_eq!(hidden, 12 + 1, "the edges of the grid and the red line");
        assert!(lines.iter().all(|line| line.opacity[0] > 0.5));
    }

    fn document() -> Document {
        let new = NewSculpture {
            dims: UVec3::splat(8),
            voxel_size: Vec3::ONE,
            colour_depth: ColourDepth::Bits24,
            base: Rgb::STONE,
            solid: true,
            room_vx: 0,
            grows: false,
        };
        Document::new(&new, Limits::default()).unwrap()
    }

    #[test]
    fn lines_that_are_switched_off_are_not_shown() {
        let mut document = document();
        let mut state = UiState::new(&Config::default().ui_options());
        let mut tool = ToolState::new(&document.contents().frame);
        let count = |state: &UiState, tool: &ToolState, document: &Document| {
            let scene = OverlayScene {
                tool,
                document,
                view: &state.view,
                theme: Theme::Dark,
                seen: None,
                pointer: None,
                stroking: false,
                sketch: None,
                marker_guide: Vec::new(),
                depth: 1.0,
            };
            (lines(&scene).len(), preview(&scene).is_some())
        };
        assert_eq!(count(&state, &tool, &document), (12 + 1 + 3 * SEGMENTS, true));
        state.view.bounds = false;
        state.view.line = false;
        assert_eq!(count(&state, &tool, &document), (3 * SEGMENTS, true));
        // A plane with its cross, and the image of the tool.
        let symmetry = Symmetry::of_axes([Some(Parity::Even), None, None]);
        document.apply(&Command::Symmetry(symmetry)).unwrap();
        assert_eq!(count(&state, &tool, &document), (6 + 6 * SEGMENTS, true));
        tool.kind = ToolKind::Marker;
        assert_eq!(count(&state, &tool, &document), (6 + 12, true));
        document.apply(&Command::Copy).unwrap();
        assert_eq!(count(&state, &tool, &document), (6 + 24, true));
        tool.kind = ToolKind::Brush(BrushId::Clay);
        assert_eq!(count(&state, &tool, &document), (6, false), "no pointer, no footprint");
        tool.kind = ToolKind::Solid;
        state.view.tool = false;
        assert_eq!(count(&state, &tool, &document), (6, false));
    }

    #[test]
    fn a_drawing_is_shown_with_its_mirror_images() {
        let mut document = document();
        let symmetry = Symmetry::of_axes([Some(Parity::Even), None, None]);
        document.apply(&Command::Symmetry(symmetry)).unwrap();
        let mut state = UiState::new(&Config::default().ui_options());
        state.view.bounds = false;
        let mut tool = ToolState::new(&document.contents().frame);
        tool.kind = ToolKind::Draw(DrawKind::Box);
        let line = [Vec3::ONE, Vec3::new(2.0, 1.0, 1.0)];
        let scene = OverlayScene {
            tool: &tool,
            document: &document,
            view: &state.view,
            theme: Theme::Dark,
            seen: None,
            pointer: None,
            stroking: false,
            sketch: Some(Sketch { mode: ToolMode::Add, lines: vec![line], faint: vec![line] }),
            marker_guide: Vec::new(),
            depth: 1.0,
        };
        let lines = lines(&scene);
        // After those of the plane.
        let ends: Vec<[Vec3; 2]> = lines.iter().skip(6).map(|line| [line.from, line.to]).collect();
        assert_eq!(ends, [line, line, [Vec3::new(7.0, 1.0, 1.0), Vec3::new(6.0, 1.0, 1.0)]]);
    }
}

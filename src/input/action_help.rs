//! The names of the actions in key tables, and their help texts.

use super::action::{Action, ActionHelp, Axis, Kind, Side, Step};
use super::draw_kind::DrawKind;
use super::panel::Panel;
use super::tool_mode::ToolMode;
use crate::sculpture::orientation::Up;
use crate::tools::brush::BrushId;
use crate::tools::solid::Solid;

fn of_brush(brush: BrushId) -> (&'static str, Kind, &'static str) {
    let spec = brush.spec();
    (spec.action, Kind::Tap, spec.help)
}

impl Action {
    /// Name, trigger and explanation.
    pub fn help(self) -> ActionHelp {
        use Kind::{Drag, Hold, Tap, Wheel};
        let (name, kind, text) = match self {
            Action::Sculpt => ("sculpt", Drag, "Use the tool; beside the sculpture, rotate it"),
            Action::SculptInverse => (
                "sculpt-inverse",
                Drag,
                "Use the tool inverted: add instead of cut, or the reverse",
            ),
            Action::SculptSmooth => {
                ("sculpt-smooth", Drag, "Use the smooth brush, whatever the current tool")
            }
            Action::PickColour => ("pick-colour", Drag, "Pick the colour of the surface"),
            Action::PickHere => ("pick-here", Tap, "Pick the colour under the pointer"),
            Action::Wand => {
                ("wand", Tap, "Mask everything connected to the voxel under the pointer")
            }
            Action::Masks => {
                ("masks", Tap, "Window of masks: voxels that are protected from tools")
            }
            Action::InvertMask => {
                ("invert-mask", Tap, "Protect what is not masked, and nothing else")
            }
            Action::ClearMask => ("clear-mask", Tap, "Clear the mask: nothing is protected"),
            Action::Flood => ("flood", Tap, "Recolour the patch of one colour under the pointer"),
            Action::Apply => ("apply", Hold, "Use the tool where it is"),
            Action::Cancel => ("cancel", Tap, "Cancel the stroke, or close a window"),
            Action::TurnSculpture => ("turn-sculpture", Drag, "Rotate the sculpture"),
            Action::PanSculpture => ("pan-sculpture", Drag, "Pan the sculpture"),
            Action::Zoom => ("zoom", Wheel, "Zoom in and out"),
            Action::MoveTool => ("move-tool", Drag, "Move the tool sideways and up or down"),
            Action::MoveToolDeep => ("move-tool-deep", Drag, "Move the tool sideways and in depth"),
            Action::TurnTool => ("turn-tool", Drag, "Rotate the tool"),
            Action::ResizeTool => ("resize-tool", Wheel, "Resize the tool"),
            Action::Solid(Solid::Ellipsoid) => ("ellipsoid", Tap, "Ellipsoid tool"),
            Action::Solid(Solid::Cuboid) => ("cuboid", Tap, "Cuboid tool"),
            Action::Solid(Solid::Pyramid) => ("pyramid", Tap, "Pyramid tool"),
            Action::Solid(Solid::Cylinder) => ("cylinder", Tap, "Cylinder tool"),
            Action::Solid(Solid::Cone) => ("cone", Tap, "Cone tool"),
            Action::Solid(Solid::Torus) => {
                ("torus", Tap, "Torus tool: a ring as thick as it is high")
            }
            Action::Solid(Solid::Capsule) => {
                ("capsule", Tap, "Capsule tool: a rod with round ends")
            }
            Action::Solid(Solid::RoundedCuboid) => {
                ("rounded-cuboid", Tap, "Rounded cuboid tool: a box with soft edges")
            }
            Action::Brush(brush) => of_brush(brush),
            Action::Draw(kind) => (kind.name(), Tap, drawn(kind)),
            Action::Marker => ("marker", Tap, "Marker: a box to select, copy and move voxels"),
            Action::Mode(ToolMode::Add) => ("add", Tap, "Add: the tool adds voxels"),
            Action::Mode(ToolMode::Subtract) => ("cut", Tap, "Cut: the tool removes voxels"),
            Action::Mode(ToolMode::Recolour) => ("paint", Tap, "Paint: the tool colours voxels"),
            Action::Mode(ToolMode::Protect | ToolMode::Release) => {
                ("protect", Tap, "Protect: the tool masks voxels, so that nothing changes them")
            }
            Action::Grow => ("grow", Tap, "Enlarge the tool"),
            Action::Shrink => ("shrink", Tap, "Shrink the tool"),
            Action::Nudge(Step::Left) => ("nudge-left", Tap, "Move the tool one voxel left"),
            Action::Nudge(Step::Right) => ("nudge-right", Tap, "Move the tool one voxel right"),
            Action::Nudge(Step::Up) => ("nudge-up", Tap, "Move the tool one voxel up"),
            Action::Nudge(Step::Down) => ("nudge-down", Tap, "Move the tool one voxel down"),
            Action::Nudge(Step::Nearer) => {
                ("nudge-nearer", Tap, "Move the tool one voxel towards you")
            }
            Action::Nudge(Step::Farther) => {
                ("nudge-farther", Tap, "Move the tool one voxel away from you")
            }
            Action::Stretch(Step::Left) => {
                ("stretch-left", Tap, "Extend the tool by one voxel on the left")
            }
            Action::Stretch(Step::Right) => {
                ("stretch-right", Tap, "Extend the tool by one voxel on the right")
            }
            Action::Stretch(Step::Up) => {
                ("stretch-up", Tap, "Extend the tool by one voxel upwards")
            }
            Action::Stretch(Step::Down) => {
                ("stretch-down", Tap, "Extend the tool by one voxel downwards")
            }
            Action::Stretch(Step::Nearer) => {
                ("stretch-nearer", Tap, "Extend the tool by one voxel towards you")
            }
            Action::Stretch(Step::Farther) => {
                ("stretch-farther", Tap, "Extend the tool by one voxel away from you")
            }
            Action::AlignTool => ("align-tool", Tap, "Reset the tool's rotation"),
            Action::ToggleSnap => ("toggle-snap", Tap, "Snap the tool to whole voxels, or not"),
            Action::Mirror(Axis::X) => ("mirror-x", Tap, "Mirror symmetry in x (left and right)"),
            Action::Mirror(Axis::Y) => ("mirror-y", Tap, "Mirror symmetry in y (up and down)"),
            Action::MirrorPlane => {
                ("mirror-plane", Tap, "Mirror symmetry about a plane placed anywhere")
            }
            Action::Radial => ("radial", Tap, "Radial symmetry: repeat tools around an axis"),
            Action::Mirror(Axis::Z) => ("mirror-z", Tap, "Mirror symmetry in z (front and back)"),
            Action::Repeat => ("repeat", Tap, "Repeat the last operation with an offset"),
            Action::SelectMarker => ("select", Tap, "Add the marker's box to the selection"),
            Action::DeselectMarker => {
                ("deselect", Tap, "Subtract the marker's box from the selection")
            }
            Action::DropBox => (
                "drop-box",
                Tap,
                "Take the last box off the selection, or the last point off the curve that is drawn",
            ),
            Action::ClearSelection => ("clear-selection", Tap, "Deselect all"),
            Action::ToggleLimit => {
                ("toggle-limit", Tap, "Limit all tools to the selection, or not")
            }
            Action::FillMarker => {
                ("fill-marker", Tap, "Fill the marker's box with the current colour")
            }
            Action::ClearMarker => ("clear-marker", Tap, "Delete the voxels in the marker"),
            Action::DyeMarker => ("dye-marker", Tap, "Recolour the voxels in the marker"),
            Action::Copy => ("copy", Tap, "Copy the voxels in the marker"),
            Action::Cut => ("cut-out", Tap, "Cut the voxels in the marker to the clipboard"),
            Action::Paste => ("paste", Tap, "Paste at the marker's lower corner, or else an image"),
            Action::TurnClip(Axis::X) => ("turn-copy-x", Tap, "Rotate the clipboard 90° about x"),
            Action::TurnClip(Axis::Y) => ("turn-copy-y", Tap, "Rotate the clipboard 90° about y"),
            Action::TurnClip(Axis::Z) => ("turn-copy-z", Tap, "Rotate the clipboard 90° about z"),
            Action::MirrorClip(Axis::X) => ("mirror-copy-x", Tap, "Mirror the clipboard along x"),
            Action::MirrorClip(Axis::Y) => ("mirror-copy-y", Tap, "Mirror the clipboard along y"),
            Action::MirrorClip(Axis::Z) => ("mirror-copy-z", Tap, "Mirror the clipboard along z"),
            Action::MoveContents(Step::Left) => {
                ("move-left", Tap, "Move the marker's contents one voxel left")
            }
            Action::MoveContents(Step::Right) => {
                ("move-right", Tap, "Move the marker's contents one voxel right")
            }
            Action::MoveContents(Step::Up) => {
                ("move-up", Tap, "Move the marker's contents one voxel up")
            }
            Action::MoveContents(Step::Down) => {
                ("move-down", Tap, "Move the marker's contents one voxel down")
            }
            Action::MoveContents(Step::Nearer) => {
                ("move-nearer", Tap, "Move the marker's contents one voxel towards you")
            }
            Action::MoveContents(Step::Farther) => {
                ("move-farther", Tap, "Move the marker's contents one voxel away from you")
            }
            Action::ToggleFollow => {
                ("toggle-follow", Tap, "Let the tool follow the pointer, or stay where it is")
            }
            Action::LeadSize => {
                ("lead-size", Tap, "Size by the pointer: further right is larger; click to keep it")
            }
            Action::LeadStrength => (
                "lead-strength",
                Tap,
                "Strength by the pointer: further right is stronger; click to keep it",
            ),
            Action::ResetTool => {
                ("reset-tool", Tap, "Reset the tool's position, rotation and size")
            }
            Action::Undo => ("undo", Tap, "Undo the last step"),
            Action::Redo => ("redo", Tap, "Redo the last undone step"),
            Action::Fill => ("fill", Tap, "Fill the whole grid"),
            Action::Clear => ("clear", Tap, "Clear the grid: delete every voxel"),
            Action::TurnUpright(up) => match up {
                Up::Z => ("upright-z", Tap, "Turn upright: the sculpture's Z axis points up"),
                Up::MinusZ => {
                    ("upright-minus-z", Tap, "Turn upright: the sculpture's −Z axis points up")
                }
                Up::MinusY => (
                    "upright-minus-y",
                    Tap,
                    "Turn upright: stand the sculpture on its head (−Y up)",
                ),
                Up::X => ("upright-x", Tap, "Turn upright: the sculpture's X axis points up"),
                Up::MinusX => {
                    ("upright-minus-x", Tap, "Turn upright: the sculpture's −X axis points up")
                }
                Up::Y => ("upright-y", Tap, "Turn upright: the sculpture's Y axis is up already"),
            },
            Action::RotateGrid(Axis::X) => {
                ("rotate-grid-x", Tap, "Rotate the whole sculpture 90° about X")
            }
            Action::RotateGrid(Axis::Y) => {
                ("rotate-grid-y", Tap, "Rotate the whole sculpture 90° about Y")
            }
            Action::RotateGrid(Axis::Z) => {
                ("rotate-grid-z", Tap, "Rotate the whole sculpture 90° about Z")
            }
            Action::ResetView => ("reset-view", Tap, "Frame all: show the whole sculpture"),
            Action::LookFrom(Side::Corner) => ("look-corner", Tap, "Corner view"),
            Action::LookFrom(Side::Front) => ("look-front", Tap, "Front view"),
            Action::LookFrom(Side::Back) => ("look-back", Tap, "Back view"),
            Action::LookFrom(Side::Left) => ("look-left", Tap, "Left view"),
            Action::LookFrom(Side::Right) => ("look-right", Tap, "Right view"),
            Action::LookFrom(Side::Top) => ("look-top", Tap, "Top view"),
            Action::LookFrom(Side::Bottom) => ("look-bottom", Tap, "Bottom view"),
            Action::NextToolMode => {
                ("next-tool-mode", Tap, "Next tool mode: cut, add, paint or protect")
            }
            Action::NextPadMode => {
                ("next-pad-mode", Tap, "Next gamepad mode: pointer, tool or sculpture")
            }
            Action::ToggleRumble => ("toggle-rumble", Tap, "Gamepad rumble on or off"),
            Action::ZoomIn => ("zoom-in", Tap, "Zoom in"),
            Action::ZoomOut => ("zoom-out", Tap, "Zoom out"),
            Action::ToggleOrthographic => (
                "toggle-orthographic",
                Tap,
                "Orthographic view (parallel lines stay parallel), or perspective",
            ),
            Action::ToggleGizmo => ("toggle-gizmo", Tap, "Axis gizmo on or off"),
            Action::References => {
                ("references", Tap, "Show or hide the reference pictures' window")
            }
            Action::ToggleGround => (
                "toggle-ground",
                Tap,
                "Ground below the sculpture, dark where the sculpture blocks the light, on or off",
            ),
            Action::ToggleFloor => ("toggle-floor", Tap, "Floor grid on or off"),
            Action::ToggleBounds => ("toggle-bounds", Tap, "Grid outline on or off"),
            Action::ToggleMask => ("toggle-mask", Tap, "Show or hide the mask"),
            Action::ToggleTheme => ("toggle-theme", Tap, "Dark or light theme"),
            Action::Fullscreen => ("fullscreen", Tap, "Full screen on or off"),
            Action::TogglePanels => ("toggle-panels", Tap, "Hide all panels, or show them again"),
            Action::Screenshot => ("screenshot", Tap, "Save a picture of the view"),
            Action::CopyScreenshot => {
                ("copy-screenshot", Tap, "Copy a picture of the view, for other programs")
            }
            Action::FinalPicture => (
                "final-picture",
                Tap,
                "Make a picture of the view with shadows and reflected light",
            ),
            Action::Tints => {
                ("colours", Tap, "Adjust the colours of an area, or give it a gradient or noise")
            }
            Action::PrintCheck => {
                ("print-check", Tap, "Check whether the sculpture can be printed, and mend it")
            }
            Action::Film => {
                ("film", Tap, "Make a film: a turntable, or a time lapse of the recording")
            }
            Action::NextRenderMode => ("next-render-mode", Tap, "Next render mode"),
            Action::NextStereo => ("next-stereo", Tap, "Next stereo layout"),
            Action::ToggleVideo => ("toggle-video", Tap, "Video background on or off"),
            Action::SwapEyes => ("swap-eyes", Tap, "Swap the left and right eye"),
            Action::ToggleHead => ("toggle-head", Tap, "Head tracking on or off"),
            Action::CalibrateHead => (
                "calibrate-head",
                Tap,
                "Calibrate the head tracker by touching the screen's corners",
            ),
            Action::ToggleAr => {
                ("toggle-ar", Tap, "Stand the sculpture on the printed marker in the video, or not")
            }
            Action::Lights => ("lights", Tap, "Show or hide the lights"),
            Action::Detach(Panel::Toolbox) => {
                ("tear-toolbox", Tap, "Detach the toolbox into its own window, or dock it")
            }
            Action::Detach(Panel::Options) => {
                ("tear-options", Tap, "Detach the options into their own window, or dock them")
            }
            Action::Detach(Panel::History) => {
                ("tear-history", Tap, "Detach the history into its own window, or dock it")
            }
            Action::ScaleUp => ("scale-up", Tap, "Enlarge the interface"),
            Action::ScaleDown => ("scale-down", Tap, "Shrink the interface"),
            Action::ScaleReset => {
                ("scale-reset", Tap, "Reset the interface to its configured size")
            }
            Action::New => ("new", Tap, "New sculpture"),
            Action::Open => ("open", Tap, "Open a sculpture or a volume"),
            Action::Save => ("save", Tap, "Save the sculpture"),
            Action::SaveAs => ("save-as", Tap, "Save the sculpture under a new name"),
            Action::Export => ("export", Tap, "Export the sculpture for other programs"),
            Action::Guide => ("guide", Tap, "Show or hide the first steps"),
            Action::Palette => ("palette", Tap, "Search actions, or type a script command"),
            Action::Help => ("help", Tap, "Show and change the controls"),
            Action::Quit => ("quit", Tap, "Quit"),
        };
        ActionHelp { name, kind, text }
    }
}

/// Describes the use of a tool that draws.
const fn drawn(kind: DrawKind) -> &'static str {
    match kind {
        DrawKind::Lasso => {
            "Lasso: draw an outline; everything behind it is cut or painted, or a slab is added"
        }
        DrawKind::Rectangle => {
            "Rectangle: drag from corner to corner; everything behind it is cut or painted, or a slab is added"
        }
        DrawKind::Plane => {
            "Plane cut: drag a line across the sculpture; the hatched side goes, or the other if inverted"
        }
        DrawKind::Box => "Box: drag its base on a face, let go, choose its height and click",
        DrawKind::Line => "Line: drag from end to end; a straight tube, or a cone, with round ends",
        DrawKind::Curve => {
            "Curve: draw a path by hand, or click from point to point; a tube along it, which may taper"
        }
        DrawKind::Lathe => {
            "Lathe: press on the axis and draw half a profile; it is turned about the vertical"
        }
        DrawKind::Text => "Text: press on the surface where the letters should stand",
    }
}

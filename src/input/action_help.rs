//! Owns what each action is called in tables of bindings, and what is said about it.

use super::action::{Action, ActionHelp, Axis, Kind, Side, Step, ToolMode};
use super::panel::Panel;
use crate::tools::construct::Solid;
use crate::tools::spray::SprayKind;

impl Action {
    /// Name, trigger and explanation.
    pub fn help(self) -> ActionHelp {
        use Kind::{Drag, Hold, Tap, Wheel};
        let (name, kind, text) = match self {
            Action::Sculpt => ("sculpt", Drag, "Use the tool; beside the sculpture, turn it"),
            Action::SculptInverse => {
                ("sculpt-inverse", Drag, "The same, but the opposite: cut for add, add for cut")
            }
            Action::SculptSmooth => ("sculpt-smooth", Drag, "Smooth, whatever tool is in hand"),
            Action::PickColour => ("pick-colour", Drag, "Take the colour of the surface"),
            Action::PickHere => ("pick-here", Tap, "Take the colour under the pointer"),
            Action::Apply => ("apply", Hold, "Use the tool where it is"),
            Action::Cancel => ("cancel", Tap, "Take back the stroke in hand, or close a window"),
            Action::TurnSculpture => ("turn-sculpture", Drag, "Turn the sculpture"),
            Action::PanSculpture => ("pan-sculpture", Drag, "Shift the sculpture"),
            Action::Zoom => ("zoom", Wheel, "Nearer and farther"),
            Action::MoveTool => ("move-tool", Drag, "Move the tool across and up"),
            Action::MoveToolDeep => ("move-tool-deep", Drag, "Move the tool across and in depth"),
            Action::TurnTool => ("turn-tool", Drag, "Turn the tool"),
            Action::ResizeTool => ("resize-tool", Wheel, "Make the tool larger and smaller"),
            Action::Solid(Solid::Ellipsoid) => ("ellipsoid", Tap, "Take the ellipsoid"),
            Action::Solid(Solid::Cuboid) => ("cuboid", Tap, "Take the cuboid"),
            Action::Solid(Solid::Pyramid) => ("pyramid", Tap, "Take the pyramid"),
            Action::Spray(SprayKind::Paintbrush) => {
                ("paintbrush", Tap, "Take the paintbrush: colours what is seen under it")
            }
            Action::Spray(SprayKind::Devourer) => {
                ("devourer", Tap, "Take the devourer: bites around every point under it")
            }
            Action::Spray(SprayKind::Clay) => {
                ("clay", Tap, "Take the clay: puts a soft mound on the surface")
            }
            Action::Spray(SprayKind::Erosion) => {
                ("erosion", Tap, "Take the erosion: wears edges off, leaves planes alone")
            }
            Action::Spray(SprayKind::Dilation) => {
                ("dilation", Tap, "Take the dilation: thickens edges and corners")
            }
            Action::Spray(SprayKind::Growth) => {
                ("growth", Tap, "Take the growth: fills corners until the surface is closed")
            }
            Action::Spray(SprayKind::Smooth) => {
                ("smooth", Tap, "Take the smoothing: evens out bumps and pits")
            }
            Action::Marker => ("marker", Tap, "Take the marker: a box to select, copy and move"),
            Action::Mode(ToolMode::Add) => ("add", Tap, "The tool adds voxels"),
            Action::Mode(ToolMode::Subtract) => ("cut", Tap, "The tool cuts voxels away"),
            Action::Mode(ToolMode::Recolour) => ("paint", Tap, "The tool colours voxels"),
            Action::Grow => ("grow", Tap, "Make the tool larger"),
            Action::Shrink => ("shrink", Tap, "Make the tool smaller"),
            Action::Nudge(Step::Left) => ("nudge-left", Tap, "Move the tool one voxel left"),
            Action::Nudge(Step::Right) => ("nudge-right", Tap, "Move the tool one voxel right"),
            Action::Nudge(Step::Up) => ("nudge-up", Tap, "Move the tool one voxel up"),
            Action::Nudge(Step::Down) => ("nudge-down", Tap, "Move the tool one voxel down"),
            Action::Nudge(Step::Nearer) => ("nudge-nearer", Tap, "Move the tool one voxel nearer"),
            Action::Nudge(Step::Farther) => {
                ("nudge-farther", Tap, "Move the tool one voxel farther")
            }
            Action::Stretch(Step::Left) => {
                ("stretch-left", Tap, "Tool one voxel longer on the left")
            }
            Action::Stretch(Step::Right) => {
                ("stretch-right", Tap, "Tool one voxel longer on the right")
            }
            Action::Stretch(Step::Up) => ("stretch-up", Tap, "Tool one voxel longer above"),
            Action::Stretch(Step::Down) => ("stretch-down", Tap, "Tool one voxel longer below"),
            Action::Stretch(Step::Nearer) => {
                ("stretch-nearer", Tap, "Tool one voxel longer in front")
            }
            Action::Stretch(Step::Farther) => {
                ("stretch-farther", Tap, "Tool one voxel longer behind")
            }
            Action::AlignTool => ("align-tool", Tap, "Turn the tool back along the grid's axes"),
            Action::ToggleSnap => ("toggle-snap", Tap, "Keep the tool on whole voxels, or not"),
            Action::Mirror(Axis::X) => ("mirror-x", Tap, "Mirror what tools do left and right (x)"),
            Action::Mirror(Axis::Y) => ("mirror-y", Tap, "Mirror what tools do up and down (y)"),
            Action::Mirror(Axis::Z) => ("mirror-z", Tap, "Mirror what tools do front and back (z)"),
            Action::Repeat => ("repeat", Tap, "Do the last operation again, further on"),
            Action::SelectMarker => ("select", Tap, "Select the marker's box, too"),
            Action::DeselectMarker => ("deselect", Tap, "Take the marker's box off the selection"),
            Action::DropBox => ("drop-box", Tap, "Drop the last box of the selection"),
            Action::ClearSelection => ("clear-selection", Tap, "Select nothing"),
            Action::ToggleLimit => ("toggle-limit", Tap, "Limit every tool to the selection"),
            Action::FillMarker => ("fill-marker", Tap, "Fill the marker's box with the colour"),
            Action::ClearMarker => ("clear-marker", Tap, "Remove what the marker holds"),
            Action::DyeMarker => ("dye-marker", Tap, "Give the colour to what the marker holds"),
            Action::Copy => ("copy", Tap, "Copy what the marker holds"),
            Action::Cut => ("cut-out", Tap, "Copy what the marker holds and remove it"),
            Action::Paste => ("paste", Tap, "Put the copy at the marker's lower corner"),
            Action::TurnClip(Axis::X) => ("turn-copy-x", Tap, "Turn the copy about x by 90°"),
            Action::TurnClip(Axis::Y) => ("turn-copy-y", Tap, "Turn the copy about y by 90°"),
            Action::TurnClip(Axis::Z) => ("turn-copy-z", Tap, "Turn the copy about z by 90°"),
            Action::MirrorClip(Axis::X) => ("mirror-copy-x", Tap, "Mirror the copy along x"),
            Action::MirrorClip(Axis::Y) => ("mirror-copy-y", Tap, "Mirror the copy along y"),
            Action::MirrorClip(Axis::Z) => ("mirror-copy-z", Tap, "Mirror the copy along z"),
            Action::MoveContents(Step::Left) => {
                ("move-left", Tap, "Move what the marker holds one voxel left")
            }
            Action::MoveContents(Step::Right) => {
                ("move-right", Tap, "Move what the marker holds one voxel right")
            }
            Action::MoveContents(Step::Up) => {
                ("move-up", Tap, "Move what the marker holds one voxel up")
            }
            Action::MoveContents(Step::Down) => {
                ("move-down", Tap, "Move what the marker holds one voxel down")
            }
            Action::MoveContents(Step::Nearer) => {
                ("move-nearer", Tap, "Move what the marker holds one voxel nearer")
            }
            Action::MoveContents(Step::Farther) => {
                ("move-farther", Tap, "Move what the marker holds one voxel farther")
            }
            Action::ToggleFollow => {
                ("toggle-follow", Tap, "Let the tool follow the pointer, or stay")
            }
            Action::ResetTool => ("reset-tool", Tap, "Tool to the centre, upright, at first size"),
            Action::Undo => ("undo", Tap, "Take back the last step"),
            Action::Redo => ("redo", Tap, "Do the undone step again"),
            Action::Fill => ("fill", Tap, "Fill the whole grid"),
            Action::Clear => ("clear", Tap, "Remove every voxel"),
            Action::ResetView => ("reset-view", Tap, "Show the whole sculpture"),
            Action::LookFrom(Side::Corner) => ("look-corner", Tap, "Look at a corner"),
            Action::LookFrom(Side::Front) => ("look-front", Tap, "Look at the front"),
            Action::LookFrom(Side::Back) => ("look-back", Tap, "Look at the back"),
            Action::LookFrom(Side::Left) => ("look-left", Tap, "Look at the left side"),
            Action::LookFrom(Side::Right) => ("look-right", Tap, "Look at the right side"),
            Action::LookFrom(Side::Top) => ("look-top", Tap, "Look at the top"),
            Action::LookFrom(Side::Bottom) => ("look-bottom", Tap, "Look at the bottom"),
            Action::NextToolMode => ("next-tool-mode", Tap, "Cut, add and paint in turn"),
            Action::NextPadMode => {
                ("next-pad-mode", Tap, "The gamepad moves pointer, tool or sculpture in turn")
            }
            Action::ToggleRumble => ("toggle-rumble", Tap, "Let the gamepad shake, or not"),
            Action::NextRenderMode => ("next-render-mode", Tap, "Take the next way of rendering"),
            Action::NextStereo => ("next-stereo", Tap, "Take the next way to show two eyes"),
            Action::ToggleVideo => ("toggle-video", Tap, "Video behind the sculpture, or not"),
            Action::SwapEyes => ("swap-eyes", Tap, "Exchange the pictures of the two eyes"),
            Action::ToggleHead => ("toggle-head", Tap, "Let the view follow the head, or not"),
            Action::CalibrateHead => {
                ("calibrate-head", Tap, "Calibrate the tracker by touching the screen's corners")
            }
            Action::ToggleAr => {
                ("toggle-ar", Tap, "Stand the sculpture on the marker in the video, or not")
            }
            Action::Lights => ("lights", Tap, "Show and change the lights"),
            Action::TearOff(Panel::Toolbox) => {
                ("tear-toolbox", Tap, "Toolbox into a window of its own, or back")
            }
            Action::TearOff(Panel::Options) => {
                ("tear-options", Tap, "Options into a window of their own, or back")
            }
            Action::TearOff(Panel::History) => {
                ("tear-history", Tap, "History into a window of its own, or back")
            }
            Action::ScaleUp => ("scale-up", Tap, "Larger text and buttons"),
            Action::ScaleDown => ("scale-down", Tap, "Smaller text and buttons"),
            Action::ScaleReset => {
                ("scale-reset", Tap, "Text and buttons as large as the settings say")
            }
            Action::New => ("new", Tap, "Make a new sculpture"),
            Action::Open => ("open", Tap, "Open a sculpture or a volume"),
            Action::Save => ("save", Tap, "Save the sculpture"),
            Action::SaveAs => ("save-as", Tap, "Save the sculpture under another name"),
            Action::Guide => ("guide", Tap, "Show the first steps"),
            Action::Palette => ("palette", Tap, "Find an action by words, or type a command"),
            Action::Help => ("help", Tap, "Show and change keys and mouse"),
            Action::Quit => ("quit", Tap, "Leave the program"),
        };
        ActionHelp { name, kind, text }
    }
}

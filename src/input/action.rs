//! Owns the vocabulary of what a person can ask for, whatever the device: each [`Action`] has
//! a name for tables of bindings and a sentence for tooltips and the help window.
//!
//! An action says what is wanted, not how it is done: `app` carries it out.

use super::panel::Panel;
use crate::tools::construct::Solid;
use crate::tools::spray::SprayKind;

/// What the tool does to the voxels it covers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum ToolMode {
    Add,
    #[default]
    Subtract,
    Recolour,
}

impl ToolMode {
    pub const ALL: [ToolMode; 3] = [ToolMode::Add, ToolMode::Subtract, ToolMode::Recolour];

    /// The mode that follows when a person goes through them.
    pub fn next(self) -> ToolMode {
        match self {
            ToolMode::Subtract => ToolMode::Add,
            ToolMode::Add => ToolMode::Recolour,
            ToolMode::Recolour => ToolMode::Subtract,
        }
    }

    /// What a mode is turned into by the modifier that inverts the tool.
    pub fn inverted(self) -> ToolMode {
        match self {
            ToolMode::Add => ToolMode::Subtract,
            ToolMode::Subtract | ToolMode::Recolour => ToolMode::Add,
        }
    }
}

/// A direction as seen on the screen.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Step {
    Left,
    Right,
    Up,
    Down,
    Nearer,
    Farther,
}

impl Step {
    pub const ALL: [Step; 6] =
        [Step::Left, Step::Right, Step::Up, Step::Down, Step::Nearer, Step::Farther];
}

/// An axis of the grid.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// 0 to 2.
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// A side of the grid to look from.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Side {
    Front,
    Back,
    Left,
    Right,
    Top,
    Bottom,
    /// From the upper right corner in front.
    Corner,
}

impl Side {
    pub const ALL: [Side; 7] =
        [Side::Corner, Side::Front, Side::Back, Side::Left, Side::Right, Side::Top, Side::Bottom];

    pub const fn name(self) -> &'static str {
        match self {
            Side::Front => "front",
            Side::Back => "back",
            Side::Left => "left",
            Side::Right => "right",
            Side::Top => "top",
            Side::Bottom => "bottom",
            Side::Corner => "3/4",
        }
    }
}

/// How an action is triggered.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// Once, by a key or a button on screen.
    Tap,
    /// From press to release, by a key or by mouse buttons on top of a running drag.
    Hold,
    /// From press to release, by mouse buttons, with the movement between.
    Drag,
    /// By notches of a wheel.
    Wheel,
}

/// Something a person can ask for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Action {
    New,
    Open,
    Save,
    SaveAs,
    Quit,
    Help,
    Undo,
    Redo,
    Fill,
    Clear,
    /// Takes back the stroke in hand, or closes what is open.
    Cancel,
    Solid(Solid),
    Spray(SprayKind),
    /// Takes the marker in hand.
    Marker,
    Mode(ToolMode),
    Grow,
    Shrink,
    ResetTool,
    /// Moves the tool by one voxel.
    Nudge(Step),
    /// Makes the tool one voxel longer on that side.
    Stretch(Step),
    /// Turns the tool's axes along the grid's.
    AlignTool,
    ToggleFollow,
    ToggleSnap,
    /// Takes the colour of the voxel under the pointer.
    PickHere,
    /// Uses solids and sprays on both sides of the plane across an axis, or no longer.
    Mirror(Axis),
    /// Does the last operation again, further on.
    Repeat,
    SelectMarker,
    DeselectMarker,
    DropBox,
    ClearSelection,
    ToggleLimit,
    FillMarker,
    ClearMarker,
    DyeMarker,
    Copy,
    Cut,
    Paste,
    /// Turns by a quarter what will be pasted.
    TurnClip(Axis),
    MirrorClip(Axis),
    /// Moves what the marker holds by one voxel.
    MoveContents(Step),
    ResetView,
    LookFrom(Side),
    NextRenderMode,
    /// Tears a panel off into a window of its own, or puts it back.
    TearOff(Panel),
    ScaleUp,
    ScaleDown,
    ScaleReset,
    /// Uses the tool while held.
    Apply,
    /// On the sculpture uses the tool, beside it turns the sculpture.
    Sculpt,
    /// As `Sculpt`, with the opposite of the tool.
    SculptInverse,
    /// Smooths, whatever tool is in hand.
    SculptSmooth,
    /// Takes the colour of the surface under the pointer.
    PickColour,
    TurnSculpture,
    PanSculpture,
    /// Moves the tool along the grid axes that lie across the screen and up it.
    MoveTool,
    /// Moves the tool along the grid axes that lie across the screen and into it.
    MoveToolDeep,
    TurnTool,
    Zoom,
    ResizeTool,
    /// Adds, cuts and paints in turn.
    NextToolMode,
    /// What the gamepad moves: pointer, tool and sculpture in turn.
    NextPadMode,
    ToggleRumble,
}

/// Name, trigger and explanation of an action.
#[derive(Clone, Copy, Debug)]
pub struct ActionHelp {
    /// The key of binding tables.
    pub name: &'static str,
    pub kind: Kind,
    /// A sentence without full stop, for tooltips and the help window.
    pub text: &'static str,
}

impl Action {
    /// Every action, in the order of the help window.
    pub const ALL: &[Action] = &[
        Action::Sculpt,
        Action::SculptInverse,
        Action::SculptSmooth,
        Action::PickColour,
        Action::PickHere,
        Action::Apply,
        Action::Cancel,
        Action::TurnSculpture,
        Action::PanSculpture,
        Action::Zoom,
        Action::MoveTool,
        Action::MoveToolDeep,
        Action::TurnTool,
        Action::ResizeTool,
        Action::Solid(Solid::Ellipsoid),
        Action::Solid(Solid::Cuboid),
        Action::Solid(Solid::Pyramid),
        Action::Mode(ToolMode::Add),
        Action::Mode(ToolMode::Subtract),
        Action::Mode(ToolMode::Recolour),
        Action::Spray(SprayKind::Paintbrush),
        Action::Spray(SprayKind::Devourer),
        Action::Spray(SprayKind::Clay),
        Action::Spray(SprayKind::Erosion),
        Action::Spray(SprayKind::Dilation),
        Action::Spray(SprayKind::Growth),
        Action::Spray(SprayKind::Smooth),
        Action::Marker,
        Action::NextToolMode,
        Action::Grow,
        Action::Shrink,
        Action::Nudge(Step::Left),
        Action::Nudge(Step::Right),
        Action::Nudge(Step::Up),
        Action::Nudge(Step::Down),
        Action::Nudge(Step::Nearer),
        Action::Nudge(Step::Farther),
        Action::Stretch(Step::Left),
        Action::Stretch(Step::Right),
        Action::Stretch(Step::Up),
        Action::Stretch(Step::Down),
        Action::Stretch(Step::Nearer),
        Action::Stretch(Step::Farther),
        Action::AlignTool,
        Action::ToggleFollow,
        Action::ToggleSnap,
        Action::ResetTool,
        Action::Mirror(Axis::X),
        Action::Mirror(Axis::Y),
        Action::Mirror(Axis::Z),
        Action::Repeat,
        Action::SelectMarker,
        Action::DeselectMarker,
        Action::DropBox,
        Action::ClearSelection,
        Action::ToggleLimit,
        Action::FillMarker,
        Action::ClearMarker,
        Action::DyeMarker,
        Action::Copy,
        Action::Cut,
        Action::Paste,
        Action::TurnClip(Axis::X),
        Action::TurnClip(Axis::Y),
        Action::TurnClip(Axis::Z),
        Action::MirrorClip(Axis::X),
        Action::MirrorClip(Axis::Y),
        Action::MirrorClip(Axis::Z),
        Action::MoveContents(Step::Left),
        Action::MoveContents(Step::Right),
        Action::MoveContents(Step::Up),
        Action::MoveContents(Step::Down),
        Action::MoveContents(Step::Nearer),
        Action::MoveContents(Step::Farther),
        Action::Undo,
        Action::Redo,
        Action::Fill,
        Action::Clear,
        Action::ResetView,
        Action::LookFrom(Side::Corner),
        Action::LookFrom(Side::Front),
        Action::LookFrom(Side::Back),
        Action::LookFrom(Side::Left),
        Action::LookFrom(Side::Right),
        Action::LookFrom(Side::Top),
        Action::LookFrom(Side::Bottom),
        Action::NextRenderMode,
        Action::TearOff(Panel::Toolbox),
        Action::TearOff(Panel::Options),
        Action::TearOff(Panel::History),
        Action::ScaleUp,
        Action::ScaleDown,
        Action::ScaleReset,
        Action::NextPadMode,
        Action::ToggleRumble,
        Action::New,
        Action::Open,
        Action::Save,
        Action::SaveAs,
        Action::Help,
        Action::Quit,
    ];

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
            Action::Help => ("help", Tap, "Show keys and mouse"),
            Action::Quit => ("quit", Tap, "Leave the program"),
        };
        ActionHelp { name, kind, text }
    }

    /// Whether holding the key down asks again and again.
    pub fn repeats(self) -> bool {
        use Action::{Grow, MoveContents, Nudge, Redo, ScaleDown, ScaleUp, Shrink, Stretch, Undo};
        matches!(
            self,
            Nudge(_)
                | Stretch(_)
                | MoveContents(_)
                | Grow
                | Shrink
                | Undo
                | Redo
                | ScaleUp
                | ScaleDown
        )
    }

    /// Whether the drag is one whole from press to release, so that a modifier pressed on the
    /// way does not turn it into another.
    pub fn is_stroke(self) -> bool {
        use Action::{PickColour, Sculpt, SculptInverse, SculptSmooth};
        matches!(self, Sculpt | SculptInverse | SculptSmooth | PickColour)
    }

    /// The action that a binding table calls `name`.
    pub fn named(name: &str) -> Option<Action> {
        Action::ALL.iter().copied().find(|action| action.help().name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_lead_back() {
        for &action in Action::ALL {
            assert_eq!(Action::named(action.help().name), Some(action));
        }
        assert_eq!(Action::named("fly"), None);
    }
}

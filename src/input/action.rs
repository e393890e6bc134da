//! Actions: everything a person can want, whatever the device. Each [`Action`] has a name for key
//! tables and a sentence for tooltips and the controls window.
//!
//! An action says what is wanted, not how it is done: `app` executes it.

use super::draw_kind::DrawKind;
use super::panel::Panel;
use super::tool_mode::ToolMode;
use crate::sculpture::orientation::Up;
use crate::tools::brush::BrushId;
use crate::tools::solid::Solid;

/// A direction on the screen.
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

    /// Index of the axis, 0 to 2.
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
    /// Once, by a key or a button of the interface.
    Tap,
    /// From press to release, by a key or by mouse buttons on top of a running drag.
    Hold,
    /// From press to release, by mouse buttons, with the movement between.
    Drag,
    /// By notches of a wheel.
    Wheel,
}

/// Everything that a person can want.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Action {
    New,
    Open,
    Save,
    SaveAs,
    /// Export a file for other programs.
    Export,
    Quit,
    Help,
    Guide,
    /// Opens the palette, which finds actions by words and takes commands.
    Palette,
    Undo,
    Redo,
    Fill,
    Clear,
    /// Cancels the running stroke, or closes what is open.
    Cancel,
    Solid(Solid),
    Brush(BrushId),
    /// Selects a tool that draws solids over the picture.
    Draw(DrawKind),
    /// Selects the marker as the tool.
    Marker,
    Mode(ToolMode),
    Grow,
    Shrink,
    /// Lets the pointer lead the size of the tool, until a click.
    LeadSize,
    /// The same with its strength.
    LeadStrength,
    ResetTool,
    /// Moves the tool by one voxel.
    Nudge(Step),
    /// Makes the tool one voxel longer on that side.
    Stretch(Step),
    /// Aligns the tool's axes with the grid's.
    AlignTool,
    ToggleFollow,
    ToggleSnap,
    /// Picks the colour of the voxel under the pointer.
    PickHere,
    /// Recolours the patch of one colour on the surface under the pointer.
    Flood,
    /// Protects what hangs together with the voxel under the pointer.
    Wand,
    /// Opens the window of masks.
    Masks,
    /// Protects what was not, and releases what was.
    InvertMask,
    /// Releases everything.
    ClearMask,
    /// Toggles the mirror plane that lies anywhere.
    MirrorPlane,
    /// Toggles the rotation of tools around an axis.
    Radial,
    /// Toggles the symmetry plane across an axis.
    Mirror(Axis),
    /// Repeats the last operation with an offset.
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
    /// Rotates the clipboard by a quarter turn.
    TurnClip(Axis),
    MirrorClip(Axis),
    /// Moves the contents of the marker by one voxel.
    MoveContents(Step),
    /// Rotates the whole sculpture so that an axis of its grid points up.
    TurnUpright(Up),
    /// Rotates the whole sculpture by a quarter about an axis of its grid.
    RotateGrid(Axis),
    ResetView,
    LookFrom(Side),
    /// Zooms by one notch, without a wheel.
    ZoomIn,
    ZoomOut,
    NextRenderMode,
    /// Toggles the window of lights.
    Lights,
    NextStereo,
    SwapEyes,
    ToggleVideo,
    /// Toggles whether the view follows the head.
    ToggleHead,
    CalibrateHead,
    /// Toggles the sculpture on the printed marker in the video.
    ToggleAr,
    /// Toggles between parallel rays and perspective.
    ToggleOrthographic,
    /// Toggles the axis gizmo.
    ToggleGizmo,
    /// Toggles the window of reference pictures.
    References,
    /// Toggles the floor grid.
    ToggleFloor,
    /// Toggles the ground with the sculpture's shadow.
    ToggleGround,
    /// Toggles the edges of the grid.
    ToggleBounds,
    /// Toggles whether the mask is seen.
    ToggleMask,
    /// Toggles between the dark and the light theme.
    ToggleTheme,
    /// Toggles full screen of the main window.
    Fullscreen,
    /// Hides the panels of the main window, or shows them again.
    TogglePanels,
    /// Saves a screenshot of the view to a file.
    Screenshot,
    /// Copies a screenshot of the view to the clipboard of the system.
    CopyScreenshot,
    /// Asks for a final picture of the view, made by tracing light.
    FinalPicture,
    /// Asks for a film of the sculpture.
    Film,
    /// Toggles the window of the print check.
    PrintCheck,
    /// Toggles the window of colours.
    Tints,
    /// Detaches a panel to a window of its own, or docks it.
    Detach(Panel),
    ScaleUp,
    ScaleDown,
    ScaleReset,
    /// Uses the tool while held.
    Apply,
    /// Uses the tool on the sculpture, rotates the view beside it.
    Sculpt,
    /// As `Sculpt`, with the inverted tool.
    SculptInverse,
    /// Smooths, whatever tool is selected.
    SculptSmooth,
    /// Picks the colour of the surface under the pointer.
    PickColour,
    TurnSculpture,
    PanSculpture,
    /// Moves the tool along the grid axes that point most across the screen and up.
    MoveTool,
    /// Moves the tool along the grid axes that point most across the screen and into it.
    MoveToolDeep,
    TurnTool,
    Zoom,
    ResizeTool,
    /// Cycles through add, cut and paint.
    NextToolMode,
    /// Cycles through what the gamepad moves: pointer, tool and sculpture.
    NextPadMode,
    ToggleRumble,
}

/// Name, trigger and explanation of an action.
#[derive(Clone, Copy, Debug)]
pub struct ActionHelp {
    /// The name in key tables.
    pub name: &'static str,
    pub kind: Kind,
    /// A sentence without full stop, for tooltips and the controls window.
    pub text: &'static str,
}

impl Action {
    /// Every action, in the order of the controls window.
    pub const ALL: &[Action] = &Action::LISTED;

    const LISTED: [Action; Action::FIRST.len() + BrushId::ALL.len() + Action::LAST.len()] = {
        let (first, brushes, last) = (Action::FIRST, BrushId::ALL, Action::LAST);
        let mut all = [Action::Sculpt; _];
        let mut i = 0;
        while i < all.len() {
            all[i] = if i < first.len() {
                first[i]
            } else if i < first.len() + brushes.len() {
                Action::Brush(brushes[i - first.len()])
            } else {
                last[i - first.len() - brushes.len()]
            };
            i += 1;
        }
        all
    };

    const FIRST: &[Action] = &[
        Action::Sculpt,
        Action::SculptInverse,
        Action::SculptSmooth,
        Action::PickColour,
        Action::PickHere,
        Action::Flood,
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
        Action::Solid(Solid::Cylinder),
        Action::Solid(Solid::Cone),
        Action::Solid(Solid::Torus),
        Action::Solid(Solid::Capsule),
        Action::Solid(Solid::RoundedCuboid),
        Action::Draw(DrawKind::Lasso),
        Action::Draw(DrawKind::Rectangle),
        Action::Draw(DrawKind::Plane),
        Action::Draw(DrawKind::Box),
        Action::Draw(DrawKind::Line),
        Action::Draw(DrawKind::Curve),
        Action::Draw(DrawKind::Lathe),
        Action::Draw(DrawKind::Text),
        Action::Mode(ToolMode::Add),
        Action::Mode(ToolMode::Subtract),
        Action::Mode(ToolMode::Recolour),
        Action::Mode(ToolMode::Protect),
    ];

    const LAST: &[Action] = &[
        Action::Wand,
        Action::Marker,
        Action::NextToolMode,
        Action::Grow,
        Action::Shrink,
        Action::LeadSize,
        Action::LeadStrength,
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
        Action::MirrorPlane,
        Action::Radial,
        Action::Repeat,
        Action::SelectMarker,
        Action::DeselectMarker,
        Action::DropBox,
        Action::ClearSelection,
        Action::ToggleLimit,
        Action::FillMarker,
        Action::ClearMarker,
        Action::DyeMarker,
        Action::RotateGrid(Axis::X),
        Action::RotateGrid(Axis::Y),
        Action::RotateGrid(Axis::Z),
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
        Action::Masks,
        Action::InvertMask,
        Action::ClearMask,
        Action::TurnUpright(Up::Z),
        Action::TurnUpright(Up::MinusZ),
        Action::TurnUpright(Up::MinusY),
        Action::TurnUpright(Up::X),
        Action::TurnUpright(Up::MinusX),
        Action::ResetView,
        Action::LookFrom(Side::Corner),
        Action::LookFrom(Side::Front),
        Action::LookFrom(Side::Back),
        Action::LookFrom(Side::Left),
        Action::LookFrom(Side::Right),
        Action::LookFrom(Side::Top),
        Action::LookFrom(Side::Bottom),
        Action::ZoomIn,
        Action::ZoomOut,
        Action::ToggleOrthographic,
        Action::ToggleGizmo,
        Action::ToggleFloor,
        Action::ToggleGround,
        Action::References,
        Action::ToggleBounds,
        Action::ToggleMask,
        Action::NextRenderMode,
        Action::Lights,
        Action::NextStereo,
        Action::SwapEyes,
        Action::ToggleVideo,
        Action::ToggleHead,
        Action::CalibrateHead,
        Action::ToggleAr,
        Action::Fullscreen,
        Action::TogglePanels,
        Action::ToggleTheme,
        Action::Detach(Panel::Toolbox),
        Action::Detach(Panel::Options),
        Action::Detach(Panel::History),
        Action::ScaleUp,
        Action::ScaleDown,
        Action::ScaleReset,
        Action::NextPadMode,
        Action::ToggleRumble,
        Action::New,
        Action::Open,
        Action::Save,
        Action::SaveAs,
        Action::Screenshot,
        Action::CopyScreenshot,
        Action::FinalPicture,
        Action::Film,
        Action::PrintCheck,
        Action::Tints,
        Action::Export,
        Action::Palette,
        Action::Help,
        Action::Guide,
        Action::Quit,
    ];

    /// Whether the action repeats while the key is held.
    pub fn repeats(self) -> bool {
        use Action::{Grow, MoveContents, Nudge, Redo, ScaleDown, ScaleUp, Shrink, Stretch, Undo};
        use Action::{ZoomIn, ZoomOut};
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
                | ZoomIn
                | ZoomOut
        )
    }

    /// Whether a drag keeps its action from press to release, so that a modifier pressed during it
    /// does not change it.
    pub fn is_stroke(self) -> bool {
        use Action::{PickColour, Sculpt, SculptInverse, SculptSmooth};
        matches!(self, Sculpt | SculptInverse | SculptSmooth | PickColour)
    }

    /// The action with a name in key tables.
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

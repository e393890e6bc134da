//! Actions: everything that a person can request, on any device.
//!
//! One table describes each [`Action`] once: its name in tables of keys, its kind of trigger, its heading in the
//! controls window, its help and the words of other programs that find it. The enum, the list of all actions and their
//! descriptions are made from that table; tools describe themselves. An action names a request; `app` executes it.

use super::draw_kind::DrawKind;
use super::group::Group;
use super::panel::Panel;
use super::tool_mode::ToolMode;
use crate::sculpture::orientation::Up;
use crate::tools::brush::BrushId;
use crate::tools::solid::Solid;

/// A direction on the screen.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ScreenDirection {
    Left,
    Right,
    Up,
    Down,
    Nearer,
    Farther,
}

impl ScreenDirection {
    pub const ALL: [ScreenDirection; 6] = [
        ScreenDirection::Left,
        ScreenDirection::Right,
        ScreenDirection::Up,
        ScreenDirection::Down,
        ScreenDirection::Nearer,
        ScreenDirection::Farther,
    ];
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

    /// Returns the index of the axis, 0 to 2.
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

/// The kind of trigger of an action.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TriggerKind {
    /// Once, by a key or a button of the interface.
    Tap,
    /// From press to release, by a key or by mouse buttons on top of a running drag.
    Hold,
    /// From press to release, by mouse buttons, with the movement between.
    Drag,
    /// By notches of a wheel.
    Wheel,
}

/// The description of an action.
#[derive(Clone, Copy, Debug)]
pub struct ActionSpec {
    /// The name in key tables.
    pub name: &'static str,
    pub kind: TriggerKind,
    /// The heading under which the controls window lists it.
    pub group: Group,
    /// A sentence without full stop, for tooltips and the controls window.
    pub text: &'static str,
    /// Words of other programs for searches, besides those of `text`, separated by spaces, in lower case and British
    /// spelling.
    pub synonyms: &'static str,
    flags: &'static [Flag],
}

/// A rare property of an action.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Flag {
    /// It repeats while its key is held.
    Repeats,
    /// Interfaces do not list it.
    Unlisted,
}

const fn is_listed(flags: &[Flag]) -> bool {
    let mut i = 0;
    while i < flags.len() {
        if matches!(flags[i], Flag::Unlisted) {
            return false;
        }
        i += 1;
    }
    true
}

/// Makes the enum, the list and the descriptions from the table. A row: `[value =>] "name" Kind Group "text" "synonyms"
/// [, Flag];`. A variant `from` a list has a row for each of those that describe themselves.
macro_rules! actions {
    ($(
        $(#[$doc:meta])*
        $variant:ident $(($of:ty))? $(from $described:ident)? {
            $( $($value:path =>)? $name:literal $kind:ident $group:ident $text:literal $synonyms:literal $(, $flag:ident)*; )*
        }
    )*) => {
        /// Everything that a person can request.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum Action {
            $( $(#[$doc])* $variant $(($of))? ),*
        }

        /// The rows of each variant, in the order of the controls window, and whether they are listed.
        const ROWS: &[&[(Action, bool)]] = &[
            $(
                $( &$described, )?
                &[ $( (Action::$variant $(($value))?, is_listed(&[$(Flag::$flag),*])) ),* ]
            ),*
        ];

        impl Action {
            /// Returns its description.
            pub fn help(self) -> ActionSpec {
                match self {
                    Action::Solid(solid) => {
                        let spec = solid.spec();
                        of_tool(spec.name, spec.help, spec.synonyms)
                    }
                    Action::Draw(kind) => {
                        let spec = kind.spec();
                        of_tool(spec.name, spec.help, spec.synonyms)
                    }
                    Action::Brush(brush) => {
                        let spec = brush.spec();
                        of_tool(spec.action, spec.help, spec.synonyms)
                    }
                    $( $(
                        Action::$variant $(($value))? => ActionSpec {
                            name: $name,
                            kind: TriggerKind::$kind,
                            group: Group::$group,
                            text: $text,
                            synonyms: $synonyms,
                            flags: &[$(Flag::$flag),*],
                        },
                    )* )*
                }
            }
        }
    };
}

actions! {
    /// Uses the tool on the sculpture, rotates the view beside it.
    Sculpt { "sculpt" Drag Pointer "Use the tool; beside the sculpture, rotate it" "carve draw"; }
    /// As `Sculpt`, with the inverted tool.
    SculptInverse { "sculpt-inverse" Drag Pointer "Use the tool inverted: add instead of cut, or the reverse" "invert opposite"; }
    /// Smooths, with any tool selected.
    SculptSmooth { "sculpt-smooth" Drag Pointer "Use the smooth brush, whatever the current tool" "relax"; }
    /// Picks the colour of the surface under the pointer.
    PickColour { "pick-colour" Drag Pointer "Pick the colour of the surface" "eyedropper pipette sample picker"; }
    /// Picks the colour of the voxel under the pointer.
    PickHere { "pick-here" Tap Pointer "Pick the colour under the pointer" "eyedropper pipette sample picker"; }
    /// Recolours the patch of one colour on the surface under the pointer.
    Flood { "flood" Tap Pointer "Recolour the patch of one colour under the pointer" "bucket fill flood paint colour"; }
    /// Uses the tool while held.
    Apply { "apply" Hold Pointer "Use the tool where it is" "stamp"; }
    /// Cancels the running stroke, or closes the topmost window.
    Cancel { "cancel" Tap Pointer "Cancel the stroke, or close a window" "abort stop escape"; }
    TurnSculpture { "turn-sculpture" Drag Pointer "Rotate the sculpture" "turn orbit spin tumble free trackball view"; }
    PanSculpture { "pan-sculpture" Drag Pointer "Pan the sculpture" "move shift translate view"; }
    Zoom { "zoom" Wheel Pointer "Zoom in and out" "dolly closer nearer farther"; }
    /// Moves the tool along the grid axes that point most across the screen and up.
    MoveTool { "move-tool" Drag Pointer "Move the tool sideways and up or down" "drag translate"; }
    /// Moves the tool along the grid axes that point most across the screen and into it.
    MoveToolDeep { "move-tool-deep" Drag Pointer "Move the tool sideways and in depth" "drag translate"; }
    TurnTool { "turn-tool" Drag Pointer "Rotate the tool" "turn"; }
    ResizeTool { "resize-tool" Wheel Pointer "Resize the tool" "size radius scale brush"; }
    /// Takes a solid in hand. The solid describes itself.
    Solid(Solid) from SOLIDS {}
    /// Selects a tool that draws solids over the picture. The tool describes itself.
    Draw(DrawKind) from DRAWN {}
    Mode(ToolMode) {
        ToolMode::Add => "add" Tap Tools "Add: the tool adds voxels" "attach build union extrude draw";
        ToolMode::Subtract => "cut" Tap Tools "Cut: the tool removes voxels" "erase eraser remove delete subtract difference";
        ToolMode::Recolour => "paint" Tap Tools "Paint: the tool colours voxels" "recolour colour dye tint";
        ToolMode::Protect => "protect" Tap Tools "Protect: the tool masks voxels, so that nothing changes them" "mask freeze lock";
        ToolMode::Release => "protect" Tap Tools "Protect: the tool masks voxels, so that nothing changes them" "mask freeze lock", Unlisted;
    }
    /// Takes a brush in hand. The brush describes itself.
    Brush(BrushId) from BRUSHES {}
    /// Protects the voxels connected to the one under the pointer.
    Wand { "wand" Tap Tools "Mask everything connected to the voxel under the pointer" "magic select connected piece flat"; }
    /// Selects the marker as the tool.
    Marker { "marker" Tap Tools "Marker: a box to select, copy and move voxels" "selection marquee rectangle region area"; }
    /// Cycles through add, cut and paint.
    NextToolMode { "next-tool-mode" Tap Tools "Next tool mode: cut, add, paint or protect" "switch toggle cycle"; }
    Grow { "grow" Tap Pose "Enlarge the tool" "larger bigger increase resize size radius scale", Repeats; }
    Shrink { "shrink" Tap Pose "Shrink the tool" "smaller decrease reduce resize size radius scale", Repeats; }
    /// Lets the pointer set the size of the tool, until a click.
    LeadSize { "lead-size" Tap Pose "Size by the pointer: further right is larger; click to keep it" "radius brush scale interactive"; }
    /// Lets the pointer set its strength likewise.
    LeadStrength { "lead-strength" Tap Pose "Strength by the pointer: further right is stronger; click to keep it" "intensity opacity brush interactive"; }
    /// Moves the tool by one voxel.
    Nudge(ScreenDirection) {
        ScreenDirection::Left => "nudge-left" Tap Pose "Move the tool one voxel left" "shift nudge", Repeats;
        ScreenDirection::Right => "nudge-right" Tap Pose "Move the tool one voxel right" "shift nudge", Repeats;
        ScreenDirection::Up => "nudge-up" Tap Pose "Move the tool one voxel up" "shift nudge", Repeats;
        ScreenDirection::Down => "nudge-down" Tap Pose "Move the tool one voxel down" "shift nudge", Repeats;
        ScreenDirection::Nearer => "nudge-nearer" Tap Pose "Move the tool one voxel towards you" "shift nudge", Repeats;
        ScreenDirection::Farther => "nudge-farther" Tap Pose "Move the tool one voxel away from you" "shift nudge", Repeats;
    }
    /// Makes the tool one voxel longer on that side.
    Stretch(ScreenDirection) {
        ScreenDirection::Left => "stretch-left" Tap Pose "Extend the tool by one voxel on the left" "stretch lengthen longer resize", Repeats;
        ScreenDirection::Right => "stretch-right" Tap Pose "Extend the tool by one voxel on the right" "stretch lengthen longer resize", Repeats;
        ScreenDirection::Up => "stretch-up" Tap Pose "Extend the tool by one voxel upwards" "stretch lengthen longer resize", Repeats;
        ScreenDirection::Down => "stretch-down" Tap Pose "Extend the tool by one voxel downwards" "stretch lengthen longer resize", Repeats;
        ScreenDirection::Nearer => "stretch-nearer" Tap Pose "Extend the tool by one voxel towards you" "stretch lengthen longer resize", Repeats;
        ScreenDirection::Farther => "stretch-farther" Tap Pose "Extend the tool by one voxel away from you" "stretch lengthen longer resize", Repeats;
    }
    /// Aligns the tool's axes with the grid's.
    AlignTool { "align-tool" Tap Pose "Reset the tool's rotation" "upright straighten align"; }
    ToggleFollow { "toggle-follow" Tap Pose "Let the tool follow the pointer, or stay where it is" "lock pin fixed"; }
    ToggleSnap { "toggle-snap" Tap Pose "Snap the tool to whole voxels, or not" "snapping magnet align"; }
    ResetTool { "reset-tool" Tap Pose "Reset the tool's position, rotation and size" "default restore centre"; }
    /// Toggles the symmetry plane across an axis.
    Mirror(Axis) {
        Axis::X => "mirror-x" Tap Repetition "Mirror symmetry in x (left and right)" "symmetric reflect flip";
        Axis::Y => "mirror-y" Tap Repetition "Mirror symmetry in y (up and down)" "symmetric reflect flip";
        Axis::Z => "mirror-z" Tap Repetition "Mirror symmetry in z (front and back)" "symmetric reflect flip";
    }
    /// Toggles the free mirror plane.
    MirrorPlane { "mirror-plane" Tap Repetition "Mirror symmetry about a plane placed anywhere" "symmetric reflect oblique free"; }
    /// Toggles the rotation of tools around an axis.
    Radial { "radial" Tap Repetition "Radial symmetry: repeat tools around an axis" "rotational kaleidoscope turn around circular polar"; }
    /// Repeats the last operation with an offset.
    Repeat { "repeat" Tap Repetition "Repeat the last operation with an offset" "array again pattern copies"; }
    SelectMarker { "select" Tap Areas "Add the marker's box to the selection" "union extend"; }
    DeselectMarker { "deselect" Tap Areas "Subtract the marker's box from the selection" "deselect unselect"; }
    DropBox { "drop-box" Tap Areas "Take the last box off the selection, or the last point off the curve that is drawn" "drop remove"; }
    ClearSelection { "clear-selection" Tap Areas "Deselect all" "deselect unselect none"; }
    ToggleLimit { "toggle-limit" Tap Areas "Limit all tools to the selection, or not" "mask restrict protect clip"; }
    FillMarker { "fill-marker" Tap Areas "Fill the marker's box with the current colour" "solid add"; }
    ClearMarker { "clear-marker" Tap Areas "Delete the voxels in the marker" "erase remove empty clear"; }
    DyeMarker { "dye-marker" Tap Areas "Recolour the voxels in the marker" "colour paint dye tint"; }
    /// Rotates the whole sculpture by a quarter about an axis of its grid.
    RotateGrid(Axis) {
        Axis::X => "rotate-grid-x" Tap History "Rotate the whole sculpture 90° about X" "turn orient orientation grid volume axes upright";
        Axis::Y => "rotate-grid-y" Tap History "Rotate the whole sculpture 90° about Y" "turn orient orientation grid volume axes upright";
        Axis::Z => "rotate-grid-z" Tap History "Rotate the whole sculpture 90° about Z" "turn orient orientation grid volume axes upright";
    }
    Copy { "copy" Tap Areas "Copy the voxels in the marker" "duplicate clone"; }
    Cut { "cut-out" Tap Areas "Cut the voxels in the marker to the clipboard" "move"; }
    Paste { "paste" Tap Areas "Paste at the marker's lower corner, or else an image" "insert stamp"; }
    /// Rotates the clipboard by a quarter turn.
    TurnClip(Axis) {
        Axis::X => "turn-copy-x" Tap Areas "Rotate the clipboard 90° about x" "turn copy";
        Axis::Y => "turn-copy-y" Tap Areas "Rotate the clipboard 90° about y" "turn copy";
        Axis::Z => "turn-copy-z" Tap Areas "Rotate the clipboard 90° about z" "turn copy";
    }
    MirrorClip(Axis) {
        Axis::X => "mirror-copy-x" Tap Areas "Mirror the clipboard along x" "flip reflect copy";
        Axis::Y => "mirror-copy-y" Tap Areas "Mirror the clipboard along y" "flip reflect copy";
        Axis::Z => "mirror-copy-z" Tap Areas "Mirror the clipboard along z" "flip reflect copy";
    }
    /// Moves the contents of the marker by one voxel.
    MoveContents(ScreenDirection) {
        ScreenDirection::Left => "move-left" Tap Areas "Move the marker's contents one voxel left" "shift nudge translate", Repeats;
        ScreenDirection::Right => "move-right" Tap Areas "Move the marker's contents one voxel right" "shift nudge translate", Repeats;
        ScreenDirection::Up => "move-up" Tap Areas "Move the marker's contents one voxel up" "shift nudge translate", Repeats;
        ScreenDirection::Down => "move-down" Tap Areas "Move the marker's contents one voxel down" "shift nudge translate", Repeats;
        ScreenDirection::Nearer => "move-nearer" Tap Areas "Move the marker's contents one voxel towards you" "shift nudge translate", Repeats;
        ScreenDirection::Farther => "move-farther" Tap Areas "Move the marker's contents one voxel away from you" "shift nudge translate", Repeats;
    }
    Undo { "undo" Tap History "Undo the last step" "back revert", Repeats; }
    Redo { "redo" Tap History "Redo the last undone step" "forward again", Repeats; }
    Fill { "fill" Tap History "Fill the whole grid" "solid block flood everything"; }
    Clear { "clear" Tap History "Clear the grid: delete every voxel" "erase remove empty reset everything all"; }
    /// Opens the window of masks.
    Masks { "masks" Tap Areas "Window of masks: voxels that are protected from tools" "mask protect grow shrink blur cavity selection freeze"; }
    /// Inverts the mask.
    InvertMask { "invert-mask" Tap Areas "Protect what is not masked, and nothing else" "inverse reverse swap"; }
    /// Clears the mask.
    ClearMask { "clear-mask" Tap Areas "Clear the mask: nothing is protected" "unmask deselect none remove"; }
    /// Rotates the whole sculpture so that an axis of its grid points up.
    TurnUpright(Up) {
        Up::Z => "upright-z" Tap History "Turn upright: the sculpture's Z axis points up" "stand lies lying face back side scan orientation orient rotate";
        Up::MinusZ => "upright-minus-z" Tap History "Turn upright: the sculpture's −Z axis points up" "stand lies lying face back side scan orientation orient rotate";
        Up::MinusY => "upright-minus-y" Tap History "Turn upright: stand the sculpture on its head (−Y up)" "upside down head scan orientation orient rotate stand";
        Up::X => "upright-x" Tap History "Turn upright: the sculpture's X axis points up" "stand lies lying face back side scan orientation orient rotate";
        Up::MinusX => "upright-minus-x" Tap History "Turn upright: the sculpture's −X axis points up" "stand lies lying face back side scan orientation orient rotate";
        Up::Y => "upright-y" Tap History "Turn upright: the sculpture's Y axis is up already" "stand lies lying face back side scan orientation orient rotate", Unlisted;
    }
    ResetView { "reset-view" Tap View "Frame all: show the whole sculpture" "fit centre recentre zoom camera see everything"; }
    LookFrom(Side) {
        Side::Corner => "look-corner" Tap View "Corner view" "look camera perspective isometric";
        Side::Front => "look-front" Tap View "Front view" "look camera side";
        Side::Back => "look-back" Tap View "Back view" "look camera side";
        Side::Left => "look-left" Tap View "Left view" "look camera side";
        Side::Right => "look-right" Tap View "Right view" "look camera side";
        Side::Top => "look-top" Tap View "Top view" "look camera side";
        Side::Bottom => "look-bottom" Tap View "Bottom view" "look camera side";
    }
    /// Zooms by one notch, without a wheel.
    ZoomIn { "zoom-in" Tap View "Zoom in" "closer nearer magnify", Repeats; }
    ZoomOut { "zoom-out" Tap View "Zoom out" "away farther further", Repeats; }
    /// Toggles between parallel rays and perspective.
    ToggleOrthographic { "toggle-orthographic" Tap View "Orthographic view (parallel lines stay parallel), or perspective" "projection ortho isometric axonometric numpad flat camera"; }
    /// Toggles the axis gizmo.
    ToggleGizmo { "toggle-gizmo" Tap View "Axis gizmo on or off" "axes navigation compass orientation cube"; }
    /// Toggles the floor grid.
    ToggleFloor { "toggle-floor" Tap View "Floor grid on or off" "plane lines scale ruler"; }
    /// Toggles the ground with the sculpture's shadow.
    ToggleGround { "toggle-ground" Tap View "Ground below the sculpture, dark where the sculpture blocks the light, on or off" "plane catcher contact lines scale"; }
    /// Toggles the window of reference pictures.
    References { "references" Tap View "Show or hide the reference pictures' window" "image plane background blueprint template tracing drawing photo png canvas"; }
    /// Toggles the edges of the grid.
    ToggleBounds { "toggle-bounds" Tap View "Grid outline on or off" "bounds box edges frame"; }
    /// Toggles the display of the mask.
    ToggleMask { "toggle-mask" Tap View "Show or hide the mask" "masking protected protect freeze frozen lock"; }
    NextRenderMode { "next-render-mode" Tap View "Next render mode" "rendering renderer shader quality gpu cpu performance"; }
    /// Toggles the window of lights.
    Lights { "lights" Tap View "Show or hide the lights" "lighting light lamp sun shadow brightness shading"; }
    NextStereo { "next-stereo" Tap View "Next stereo layout" "3d glasses anaglyph two eyes"; }
    SwapEyes { "swap-eyes" Tap View "Swap the left and right eye" "exchange stereo reverse"; }
    ToggleVideo { "toggle-video" Tap View "Video background on or off" "camera webcam backdrop"; }
    /// Toggles whether the view follows the head.
    ToggleHead { "toggle-head" Tap View "Head tracking on or off" "tracker webcam opentrack"; }
    CalibrateHead { "calibrate-head" Tap View "Calibrate the head tracker by touching the screen's corners" "tracking"; }
    /// Toggles the sculpture on the printed marker in the video.
    ToggleAr { "toggle-ar" Tap View "Stand the sculpture on the printed marker in the video, or not" "augmented reality webcam ar"; }
    /// Toggles full screen of the main window.
    Fullscreen { "fullscreen" Tap View "Full screen on or off" "fullscreen maximise window"; }
    /// Hides the panels of the main window, or shows them again.
    TogglePanels { "toggle-panels" Tap View "Hide all panels, or show them again" "interface toolbars distraction free zen clean presentation tab maximise"; }
    /// Toggles between the dark and the light theme.
    ToggleTheme { "toggle-theme" Tap Program "Dark or light theme" "mode appearance skin colours"; }
    /// Detaches a panel to a window of its own, or docks it.
    Detach(Panel) {
        Panel::Toolbox => "tear-toolbox" Tap Program "Detach the toolbox into its own window, or dock it" "tools panel undock float tear window";
        Panel::Options => "tear-options" Tap Program "Detach the options into their own window, or dock them" "panel undock float tear window";
        Panel::History => "tear-history" Tap Program "Detach the history into its own window, or dock it" "panel undock float tear window";
    }
    ScaleUp { "scale-up" Tap Program "Enlarge the interface" "larger bigger text font size zoom dpi", Repeats; }
    ScaleDown { "scale-down" Tap Program "Shrink the interface" "smaller text font size zoom dpi", Repeats; }
    ScaleReset { "scale-reset" Tap Program "Reset the interface to its configured size" "text font zoom dpi default"; }
    /// Cycles the target of the gamepad: pointer, tool and sculpture.
    NextPadMode { "next-pad-mode" Tap Pointer "Next gamepad mode: pointer, tool or sculpture" "controller joystick"; }
    ToggleRumble { "toggle-rumble" Tap Program "Gamepad rumble on or off" "vibration vibrate haptics shake controller"; }
    New { "new" Tap Program "New sculpture" "create file"; }
    Open { "open" Tap Program "Open a sculpture or a volume" "load import read browse file"; }
    Save { "save" Tap Program "Save the sculpture" "write store file"; }
    SaveAs { "save-as" Tap Program "Save the sculpture under a new name" "convert copy rename file"; }
    /// Saves a screenshot of the view to a file.
    Screenshot { "screenshot" Tap Program "Save a picture of the view" "screenshot capture snapshot photo image png export render"; }
    /// Copies a screenshot of the view to the clipboard of the system.
    CopyScreenshot { "copy-screenshot" Tap Program "Copy a picture of the view, for other programs" "screenshot capture snapshot photo image clipboard system paste"; }
    /// Opens the dialog of a final picture by path tracing.
    FinalPicture { "final-picture" Tap Program "Make a picture of the view with shadows and reflected light" "final render raytrace path trace shadow sun photo image"; }
    /// Opens the dialog of a film of the sculpture.
    Film { "film" Tap Program "Make a film: a turntable, or a time lapse of the recording" "movie video animation turntable spin rotate time lapse gif apng export"; }
    /// Toggles the window of the print check.
    PrintCheck { "print-check" Tap Program "Check whether the sculpture can be printed, and mend it" "printing printer slicer support overhang thin wall island cavity hollow repair analyse"; }
    /// Toggles the window of the canvas.
    Canvas { "canvas" Tap Program "Set the size of the canvas, let it grow, crop it, or change the resolution" "canvas size dimensions enlarge extend room crop resize resample resolution remesh"; }
    /// Toggles the window of colours.
    Tints { "colours" Tap Program "Adjust the colours of an area, or give it a gradient or noise" "colour hue saturation value brightness contrast gradient ramp noise speckle tint hsv"; }
    /// Exports a file for other programs.
    Export { "export" Tap Program "Export the sculpture for other programs" "write convert volume pvm raw stl obj ply glb gltf 3mf vox mesh other programs file"; }
    /// Opens the palette, which finds actions by words and takes commands.
    Palette { "palette" Tap Program "Search actions, or type a script command" "find command menu"; }
    Help { "help" Tap Program "Show and change the controls" "shortcuts hotkeys keys keyboard mouse gamepad keybindings bindings keymap preferences settings options configure customise manual"; }
    Guide { "guide" Tap Program "Show or hide the first steps" "tutorial learn lesson introduction getting started welcome tips"; }
    Quit { "quit" Tap Program "Quit" "exit leave end close program"; }
}

/// Returns the description of the action that takes a tool in hand.
const fn of_tool(name: &'static str, text: &'static str, synonyms: &'static str) -> ActionSpec {
    ActionSpec { name, kind: TriggerKind::Tap, group: Group::Tools, text, synonyms, flags: &[] }
}

/// Makes the rows of the actions that take a tool in hand.
macro_rules! rows_of {
    ($variant:ident, $all:expr) => {{
        let mut rows = [(Action::Quit, true); $all.len()];
        let mut i = 0;
        while i < rows.len() {
            rows[i].0 = Action::$variant($all[i]);
            i += 1;
        }
        rows
    }};
}

const SOLIDS: [(Action, bool); Solid::ALL.len()] = rows_of!(Solid, Solid::ALL);
const DRAWN: [(Action, bool); DrawKind::ALL.len()] = rows_of!(Draw, DrawKind::ALL);
const BRUSHES: [(Action, bool); BrushId::ALL.len()] = rows_of!(Brush, BrushId::ALL);

/// Returns the listed actions in order, up to `N`, and their number.
const fn listed<const N: usize>() -> ([Action; N], usize) {
    let mut all = [Action::Quit; N];
    let (mut n, mut variant) = (0, 0);
    while variant < ROWS.len() {
        let rows = ROWS[variant];
        let mut row = 0;
        while row < rows.len() {
            if rows[row].1 {
                if n < N {
                    all[n] = rows[row].0;
                }
                n += 1;
            }
            row += 1;
        }
        variant += 1;
    }
    (all, n)
}

const LISTED: [Action; listed::<0>().1] = listed().0;

impl Action {
    /// Every action, in the order of the controls window.
    pub const ALL: &[Action] = &LISTED;

    /// Returns whether the action repeats while the key is held.
    pub fn repeats(self) -> bool {
        self.help().flags.contains(&Flag::Repeats)
    }

    /// Returns whether a drag keeps its action from press to release, so that a modifier pressed during it does not
    /// change it.
    pub fn is_stroke(self) -> bool {
        use Action::{PickColour, Sculpt, SculptInverse, SculptSmooth};
        matches!(self, Sculpt | SculptInverse | SculptSmooth | PickColour)
    }

    /// Returns the action with a name in key tables.
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

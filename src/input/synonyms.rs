//! Synonyms of actions: the words of other programs, by which the palette and the filter of the
//! controls window find them.
//!
//! In lower case and British spelling, like normalised searches; words of the action's own help are
//! not repeated.

use super::action::{Action, Side};
use super::draw_kind::DrawKind;
use super::panel::Panel;
use super::tool_mode::ToolMode;
use crate::sculpture::orientation::Up;
use crate::tools::solid::Solid;

impl Action {
    /// Words that find the action besides those of its help, separated by spaces.
    pub fn synonyms(self) -> &'static str {
        match self {
            Action::New => "create file",
            Action::Open => "load import read browse file",
            Action::Save => "write store file",
            Action::SaveAs => "convert copy rename file",
            Action::Export => {
                "write convert volume pvm raw stl obj ply glb gltf 3mf vox mesh other programs file"
            }
            Action::Screenshot => "screenshot capture snapshot photo image png export render",
            Action::CopyScreenshot => {
                "screenshot capture snapshot photo image clipboard system paste"
            }
            Action::FinalPicture => "final render raytrace path trace shadow sun photo image",
            Action::PrintCheck => {
                "printing printer slicer support overhang thin wall island cavity hollow repair analyse"
            }
            Action::Tints => {
                "colour hue saturation value brightness contrast gradient ramp noise speckle tint hsv"
            }
            Action::Film => {
                "movie video animation turntable spin rotate time lapse gif apng export"
            }
            Action::Fullscreen => "fullscreen maximise window",
            Action::TogglePanels => {
                "interface toolbars distraction free zen clean presentation tab maximise"
            }
            Action::Quit => "exit leave end close program",
            Action::Help => {
                "shortcuts hotkeys keys keyboard mouse gamepad keybindings bindings keymap \
                 preferences settings options configure customise manual"
            }
            Action::Guide => "tutorial learn lesson introduction getting started welcome tips",
            Action::Palette => "find command menu",
            Action::Undo => "back revert",
            Action::Redo => "forward again",
            Action::Fill => "solid block flood everything",
            Action::Clear => "erase remove empty reset everything all",
            Action::TurnUpright(Up::MinusY) => {
                "upside down head scan orientation orient rotate stand"
            }
            Action::TurnUpright(_) => {
                "stand lies lying face back side scan orientation orient rotate"
            }
            Action::RotateGrid(_) => "turn orient orientation grid volume axes upright",
            Action::Cancel => "abort stop escape",
            Action::Solid(Solid::Ellipsoid) => "sphere ball round",
            Action::Solid(Solid::Cuboid) => "cube box block brick square",
            Action::Solid(Solid::Pyramid) => "roof triangle",
            Action::Solid(Solid::Cylinder) => "tube rod column pillar disc can wheel",
            Action::Solid(Solid::Cone) => "spike tip hat spire",
            Action::Solid(Solid::Torus) => "ring donut doughnut handle tyre",
            Action::Solid(Solid::Capsule) => "pill sausage rod limb finger",
            Action::Solid(Solid::RoundedCuboid) => "rounded box soft cushion pillow",
            Action::Brush(brush) => brush.spec().synonyms,
            Action::Draw(DrawKind::Lasso) => "trim slice polygon freehand extrude",
            Action::Draw(DrawKind::Rectangle) => "trim square crop extrude",
            Action::Draw(DrawKind::Plane) => "slice split halve half space section trim knife",
            Action::Draw(DrawKind::Box) => "block cuboid brick wall rectangle",
            Action::Draw(DrawKind::Line) => "rod stick pipe capsule strut edge",
            Action::Draw(DrawKind::Curve) => "spline pipe worm handle rope freehand sweep snake",
            Action::Draw(DrawKind::Lathe) => "revolve pottery vase bowl wheel turned spin",
            Action::Draw(DrawKind::Text) => "type write lettering engrave emboss inscription word",
            Action::Marker => "selection marquee rectangle region area",
            Action::Mode(ToolMode::Add) => "attach build union extrude draw",
            Action::Mode(ToolMode::Subtract) => "erase eraser remove delete subtract difference",
            Action::Mode(ToolMode::Protect | ToolMode::Release) => "mask freeze lock",
            Action::Mode(ToolMode::Recolour) => "recolour colour dye tint",
            Action::NextToolMode => "switch toggle cycle",
            Action::Grow => "larger bigger increase resize size radius scale",
            Action::Shrink => "smaller decrease reduce resize size radius scale",
            Action::LeadSize => "radius brush scale interactive",
            Action::LeadStrength => "intensity opacity brush interactive",
            Action::ResetTool => "default restore centre",
            Action::Nudge(_) => "shift nudge",
            Action::Stretch(_) => "stretch lengthen longer resize",
            Action::AlignTool => "upright straighten align",
            Action::ToggleFollow => "lock pin fixed",
            Action::ToggleSnap => "snapping magnet align",
            Action::PickHere | Action::PickColour => "eyedropper pipette sample picker",
            Action::Wand => "magic select connected piece flat",
            Action::Masks => "mask protect grow shrink blur cavity selection freeze",
            Action::InvertMask => "inverse reverse swap",
            Action::ClearMask => "unmask deselect none remove",
            Action::Flood => "bucket fill flood paint colour",
            Action::MirrorPlane => "symmetric reflect oblique free",
            Action::Radial => "rotational kaleidoscope turn around circular polar",
            Action::Mirror(_) => "symmetric reflect flip",
            Action::Repeat => "array again pattern copies",
            Action::SelectMarker => "union extend",
            Action::DeselectMarker => "deselect unselect",
            Action::DropBox => "drop remove",
            Action::ClearSelection => "deselect unselect none",
            Action::ToggleLimit => "mask restrict protect clip",
            Action::FillMarker => "solid add",
            Action::ClearMarker => "erase remove empty clear",
            Action::DyeMarker => "colour paint dye tint",
            Action::Copy => "duplicate clone",
            Action::Cut => "move",
            Action::Paste => "insert stamp",
            Action::TurnClip(_) => "turn copy",
            Action::MirrorClip(_) => "flip reflect copy",
            Action::MoveContents(_) => "shift nudge translate",
            Action::ResetView => "fit centre recentre zoom camera see everything",
            Action::LookFrom(Side::Corner) => "look camera perspective isometric",
            Action::LookFrom(_) => "look camera side",
            Action::ZoomIn => "closer nearer magnify",
            Action::ZoomOut => "away farther further",
            Action::NextRenderMode => "rendering renderer shader quality gpu cpu performance",
            Action::Lights => "lighting light lamp sun shadow brightness shading",
            Action::NextStereo => "3d glasses anaglyph two eyes",
            Action::SwapEyes => "exchange stereo reverse",
            Action::ToggleVideo => "camera webcam backdrop",
            Action::ToggleHead => "tracker webcam opentrack",
            Action::CalibrateHead => "tracking",
            Action::ToggleAr => "augmented reality webcam ar",
            Action::ToggleOrthographic => {
                "projection ortho isometric axonometric numpad flat camera"
            }
            Action::ToggleGizmo => "axes navigation compass orientation cube",
            Action::References => {
                "image plane background blueprint template tracing drawing photo png canvas"
            }
            Action::ToggleFloor => "plane lines scale ruler",
            Action::ToggleGround => "plane catcher contact lines scale",
            Action::ToggleBounds => "bounds box edges frame",
            Action::ToggleMask => "masking protected protect freeze frozen lock",
            Action::ToggleTheme => "mode appearance skin colours",
            Action::Detach(Panel::Toolbox) => "tools panel undock float tear window",
            Action::Detach(_) => "panel undock float tear window",
            Action::ScaleUp => "larger bigger text font size zoom dpi",
            Action::ScaleDown => "smaller text font size zoom dpi",
            Action::ScaleReset => "text font zoom dpi default",
            Action::NextPadMode => "controller joystick",
            Action::ToggleRumble => "vibration vibrate haptics shake controller",
            Action::Apply => "stamp",
            Action::Sculpt => "carve draw",
            Action::SculptInverse => "invert opposite",
            Action::SculptSmooth => "relax",
            Action::TurnSculpture => "turn orbit spin tumble free trackball view",
            Action::PanSculpture => "move shift translate view",
            Action::Zoom => "dolly closer nearer farther",
            Action::MoveTool | Action::MoveToolDeep => "drag translate",
            Action::TurnTool => "turn",
            Action::ResizeTool => "size radius scale brush",
        }
    }
}

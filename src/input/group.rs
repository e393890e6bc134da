//! The headings under which the controls window lists the actions.

use super::action::Action;

/// The subject of an action.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Group {
    Pointer,
    Tools,
    Pose,
    Repetition,
    Areas,
    History,
    View,
    Program,
}

impl Group {
    pub const ALL: [Group; 8] = [
        Group::Pointer,
        Group::Tools,
        Group::Pose,
        Group::Repetition,
        Group::Areas,
        Group::History,
        Group::View,
        Group::Program,
    ];

    pub const fn title(self) -> &'static str {
        match self {
            Group::Pointer => "Pointer",
            Group::Tools => "Tools",
            Group::Pose => "Tool size and position",
            Group::Repetition => "Symmetry and array",
            Group::Areas => "Marker, selection and clipboard",
            Group::History => "History and grid",
            Group::View => "View",
            Group::Program => "Files and program",
        }
    }

    pub const fn of(action: Action) -> Group {
        use Action::*;
        match action {
            Sculpt | SculptInverse | SculptSmooth | PickColour | PickHere | Flood | Apply
            | Cancel | TurnSculpture | PanSculpture | Zoom | MoveTool | MoveToolDeep | TurnTool
            | ResizeTool | NextPadMode => Group::Pointer,
            Solid(_) | Draw(_) | Mode(_) | Wand | NextToolMode | Brush(_) | Marker => Group::Tools,
            Grow | Shrink | LeadSize | LeadStrength | Nudge(_) | Stretch(_) | AlignTool
            | ToggleFollow | ToggleSnap | ResetTool => Group::Pose,
            Mirror(_) | MirrorPlane | Radial | Repeat => Group::Repetition,
            SelectMarker | DeselectMarker | DropBox | ClearSelection | ToggleLimit | FillMarker
            | ClearMarker | DyeMarker | Copy | Cut | Paste | TurnClip(_) | MirrorClip(_)
            | MoveContents(_) | Masks | InvertMask | ClearMask => Group::Areas,
            Undo | Redo | Fill | Clear | TurnUpright(_) | RotateGrid(_) => Group::History,
            ResetView | LookFrom(_) | ZoomIn | ZoomOut | ToggleOrthographic | ToggleGizmo
            | ToggleMask | ToggleFloor | ToggleGround | References | ToggleBounds
            | NextRenderMode | NextStereo | SwapEyes | ToggleVideo | ToggleHead | CalibrateHead
            | ToggleAr | Lights | Fullscreen | TogglePanels => Group::View,
            ScaleUp | ScaleDown | ScaleReset | ToggleTheme | Detach(_) | ToggleRumble | New
            | Open | Save | SaveAs | Export | Screenshot | CopyScreenshot | FinalPicture | Film
            | PrintCheck | Tints | Palette | Help | Guide | Quit => Group::Program,
        }
    }
}

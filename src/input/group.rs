//! The headings under which the controls window lists the actions.

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
}

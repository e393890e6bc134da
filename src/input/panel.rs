//! The panels that can be detached to windows of their own.

/// A panel.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Panel {
    Toolbox,
    Options,
    History,
}

impl Panel {
    pub const ALL: [Panel; 3] = [Panel::Toolbox, Panel::Options, Panel::History];

    /// Returns the name in the interface.
    pub const fn title(self) -> &'static str {
        match self {
            Panel::Toolbox => "Toolbox",
            Panel::Options => "Options",
            Panel::History => "History",
        }
    }
}

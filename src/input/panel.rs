//! Owns the names of the panels that can be detached off into windows of their own.

/// A panel.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Panel {
    Toolbox,
    Options,
    History,
}

impl Panel {
    pub const ALL: [Panel; 3] = [Panel::Toolbox, Panel::Options, Panel::History];

    /// What the interface calls it.
    pub const fn title(self) -> &'static str {
        match self {
            Panel::Toolbox => "Toolbox",
            Panel::Options => "Options",
            Panel::History => "History",
        }
    }
}

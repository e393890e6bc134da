//! The tools that deform clay, as interfaces name them.

/// A tool that deforms clay, without its options.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum DeformKind {
    /// Takes hold of a ball of clay and pulls it along.
    #[default]
    Grab,
}

impl DeformKind {
    /// All kinds, in the order in which interfaces offer them.
    pub const ALL: [DeformKind; 1] = [DeformKind::Grab];

    /// Its name in the text form and the interface.
    pub const fn name(self) -> &'static str {
        match self {
            DeformKind::Grab => "grab",
        }
    }
}

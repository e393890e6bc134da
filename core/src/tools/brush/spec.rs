//! What a brush is, as its file says: everything that people read of it, once for scripts, keys, panels and the palette.

/// The description of a brush.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BrushSpec {
    /// In scripts, in labels of undo steps, and in what is remembered.
    pub name: &'static str,
    /// In tables of keys.
    pub action: &'static str,
    /// In the interface.
    pub label: &'static str,
    /// What it does, in one sentence.
    pub help: &'static str,
    /// Words of other programs that find it, besides those of `help`, separated by spaces.
    pub synonyms: &'static str,
}

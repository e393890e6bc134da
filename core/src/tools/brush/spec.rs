//! Describes a brush: the texts that scripts, key tables, panels and the palette show, each written once in the file of the
//! brush. Knows no function of a brush.

/// The description of a brush.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BrushSpec {
    /// In scripts, in labels of undo steps, and in what is remembered.
    pub name: &'static str,
    /// In tables of keys.
    pub action: &'static str,
    /// In the interface.
    pub label: &'static str,
    /// Explains the brush in one sentence.
    pub help: &'static str,
    /// Words of other programs that find it, besides those of `help`, separated by spaces.
    pub synonyms: &'static str,
}

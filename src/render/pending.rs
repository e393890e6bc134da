//! The part of a picture in memory that is not yet on the device.

use crate::surface::PixelRect;

/// The part of a picture to upload.
#[derive(Clone, Copy, Default)]
pub(super) enum Pending {
    #[default]
    Nothing,
    /// The rows of these pixels; the others on the device are up to date.
    Changed(PixelRect),
    All,
}

impl Pending {
    /// Returns the union with more changed pixels; `None`: all may have changed.
    pub fn and(self, more: Option<PixelRect>) -> Pending {
        let Some(more) = more else { return Pending::All };
        match self {
            Pending::Changed(rect) if more.is_empty() => Pending::Changed(rect),
            Pending::Changed(rect) if !rect.is_empty() => Pending::Changed(rect.union(more)),
            Pending::Nothing | Pending::Changed(_) => Pending::Changed(more),
            Pending::All => Pending::All,
        }
    }
}

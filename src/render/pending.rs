//! The part of a picture in memory that is not yet on the device.

use crate::surface::PixelRect;

/// The part of a picture to upload.
#[derive(Clone, Copy, Default)]
pub(super) enum PendingUpload {
    #[default]
    Nothing,
    /// The rows of these pixels; the others on the device are up to date.
    Changed(PixelRect),
    All,
}

impl PendingUpload {
    /// Returns the union with more changed pixels; `None`: all may have changed.
    pub fn and(self, more: Option<PixelRect>) -> PendingUpload {
        let Some(more) = more else { return PendingUpload::All };
        match self {
            PendingUpload::Changed(rect) if more.is_empty() => PendingUpload::Changed(rect),
            PendingUpload::Changed(rect) if !rect.is_empty() => {
                PendingUpload::Changed(rect.union(more))
            }
            PendingUpload::Nothing | PendingUpload::Changed(_) => PendingUpload::Changed(more),
            PendingUpload::All => PendingUpload::All,
        }
    }
}

//! Memory limits of a sculpture and its history, checked before anything is allocated.

/// Memory that a document may take, in bytes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Limits {
    /// For the existence bits of a grid.
    pub grid_bytes: u64,
    /// For the colours of a sculpture.
    pub colour_bytes: u64,
    /// For all steps that can be undone or redone.
    pub history_bytes: usize,
    /// On disk, for the steps that do not fit into memory, if a session gives them a file.
    pub history_disk_bytes: u64,
}

impl Limits {
    /// No limits: for what has been in memory before.
    pub(crate) const NONE: Limits = Limits {
        grid_bytes: u64::MAX,
        colour_bytes: u64::MAX,
        history_bytes: usize::MAX,
        history_disk_bytes: u64::MAX,
    };
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            grid_bytes: 1 << 30,
            colour_bytes: 4 << 30,
            history_bytes: 1 << 30,
            history_disk_bytes: 0,
        }
    }
}

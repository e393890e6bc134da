//! Counts of an edit's changes, which a stroke sums up.
//!
//! Holds numbers only; knows neither edits nor strokes.

/// Counts of an edit's changes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct EditStats {
    /// Voxels that exist now and did not before.
    pub voxels_added: u64,
    /// Voxels that existed before and do not exist now.
    pub voxels_removed: u64,
    /// Voxels that existed before and have another colour now.
    pub voxels_recoloured: u64,
    /// Voxels whose protection has changed, in either direction.
    pub voxels_masked: u64,
    /// Bricks whose bits, colours or mask changed.
    pub bricks_changed: u64,
}

impl EditStats {
    /// Returns the number of voxels added, removed, recoloured, protected or released.
    pub fn voxels_changed(&self) -> u64 {
        self.voxels_added + self.voxels_removed + self.voxels_recoloured + self.voxels_masked
    }
}

impl std::ops::AddAssign for EditStats {
    fn add_assign(&mut self, other: EditStats) {
        self.voxels_added += other.voxels_added;
        self.voxels_removed += other.voxels_removed;
        self.voxels_recoloured += other.voxels_recoloured;
        self.voxels_masked += other.voxels_masked;
        self.bricks_changed += other.bricks_changed;
    }
}

//! Keeps data of the meshes that a session writes, and tracks the changes of the sculpture between them.
//!
//! Takes the document at the time of a save; returns a numbered version of its contents for the [`MeshCache`]. Makes no
//! mesh.

use std::sync::Arc;

use crate::document::{ChangeSubscriber, Document};
use crate::mesh::{ContentsVersion, MeshCache};

/// See the module text.
#[derive(Debug, Default)]
pub(super) struct KeptMeshes {
    cache: Arc<MeshCache>,
    subscriber: ChangeSubscriber,
    /// The number of the last version.
    last: u64,
}

impl KeptMeshes {
    /// Returns the version of the present document, for a mesh about to be written. Each version states the differences
    /// from the one before, whether that was written or not.
    pub(crate) fn next_version(
        &mut self,
        document: &mut Document,
    ) -> (Arc<MeshCache>, ContentsVersion) {
        self.last += 1;
        let list = |bricks: &[u32]| bricks.to_vec();
        let changed = document.drain_changes_for(&self.subscriber, |_, bricks| bricks.map(list));
        (Arc::clone(&self.cache), ContentsVersion { number: self.last, changed })
    }

    /// Releases the memory of the last mesh.
    pub fn clear(&self) {
        self.cache.clear();
    }
}

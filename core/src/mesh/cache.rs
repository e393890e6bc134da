//! The mesh of the last export, so that the next one of the same kind rebuilds only what has changed since.
//!
//! It takes memory until the next export, up to a share of the memory for meshes. Larger meshes are not cached, so that
//! they are in memory only once. Greedy meshes are always built whole.
//! are in memory once. Greedy meshes are made at once.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{
    Budget, ContentsVersion, KeptMesh, Mesh, MeshError, MeshKind, VertexColours, bytes_of_faces,
};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::Contents;

/// The divisor of the memory for meshes that a cached one may take.
const SHARE: u64 = 4;

/// See the module text.
#[derive(Debug, Default)]
pub struct MeshCache {
    kept: Mutex<Option<KeptMesh>>,
}

/// A cache for the contents of one version.
#[derive(Clone, Copy, Debug)]
pub struct VersionedMeshCache<'a> {
    cache: &'a MeshCache,
    version: &'a ContentsVersion,
}

impl MeshCache {
    /// Returns the cache for the contents of version `version`.
    pub fn at<'a>(&'a self, version: &'a ContentsVersion) -> VersionedMeshCache<'a> {
        VersionedMeshCache { cache: self, version }
    }

    /// Frees its memory.
    pub fn clear(&self) {
        *self.lock() = None;
    }

    /// Locks the cached mesh. A poisoned lock does no harm: the mesh of the last export is only a copy.
    fn lock(&self) -> MutexGuard<'_, Option<KeptMesh>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl VersionedMeshCache<'_> {
    /// Returns the mesh of `contents`, which have this version: that of [`Mesh::of`], except for the order of its
    /// parts.
    pub(crate) fn mesh_of(
        &self,
        contents: &Contents,
        kind: MeshKind,
        colours: VertexColours,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<Mesh, MeshError> {
        let most = Budget::new(limits).bytes() / SHARE;
        let mut slot = self.cache.lock();
        let former = slot.take().filter(|kept| kept.is_of(kind, colours));
        let is_small = bytes_of_faces(contents, colours.are_in(contents)) <= most;
        let Some(mut kept) = former.or_else(|| KeptMesh::new(kind, colours)).filter(|_| is_small)
        else {
            return Mesh::of(contents, kind, colours, limits, progress);
        };
        kept.update(contents, self.version, limits, progress)?;
        let mesh = kept.mesh()?;
        if kept.heap_bytes() <= most {
            *slot = Some(kept);
        }
        Ok(mesh)
    }
}

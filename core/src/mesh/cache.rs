//! The mesh of the last export, so that the next one of the same kind makes anew only what has changed since.
//!
//! It takes memory until the next export, within a share of what meshes may take; larger ones are not kept, so that they
//! are in memory once. Greedy meshes are made at once.

use std::sync::{Mutex, PoisonError};

use super::{
    Budget, ContentsVersion, KeptMesh, Mesh, MeshError, MeshKind, VertexColours, bytes_of_faces,
};
use crate::progress::Progress;
use crate::sculpture::Limits;
use crate::sculpture::history::Contents;

/// The part of the memory for meshes that a kept one may take.
const SHARE: u64 = 4;

/// See the module text.
#[derive(Debug, Default)]
pub struct MeshCache {
    kept: Mutex<Option<KeptMesh>>,
}

impl MeshCache {
    /// The mesh of `contents`, which are `version` of all that it was asked for, as [`Mesh::of`] makes it but for the
    /// order of its parts.
    pub fn mesh_of(
        &self,
        contents: &Contents,
        version: &ContentsVersion,
        kind: MeshKind,
        colours: VertexColours,
        limits: &Limits,
        progress: &dyn Progress,
    ) -> Result<Mesh, MeshError> {
        let most = Budget::new(limits).bytes() / SHARE;
        // A poisoned lock does no harm: the mesh that the last export left is only a copy.
        let mut slot = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let former = slot.take().filter(|kept| kept.is_of(kind, colours));
        let is_small = bytes_of_faces(contents, colours.are_in(contents)) <= most;
        let Some(mut kept) = former.or_else(|| KeptMesh::new(kind, colours)).filter(|_| is_small)
        else {
            return Mesh::of(contents, kind, colours, limits, progress);
        };
        kept.update(contents, version, limits, progress)?;
        let mesh = kept.mesh()?;
        if kept.heap_bytes() <= most {
            *slot = Some(kept);
        }
        Ok(mesh)
    }

    /// Gives its memory back.
    pub fn clear(&self) {
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

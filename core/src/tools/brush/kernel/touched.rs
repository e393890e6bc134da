//! Finds the surface voxels that a footprint selects.
//!
//! From a footprint and a grid to [`TouchedVoxel`]s. A footprint selects either the visible voxels whose projection lies
//! inside its outline ([`visible`]) or, for commands recorded by earlier versions, the voxels that its rays meet.
//! Changes nothing; knows no brush.

use std::collections::HashSet;

use super::visible;
use crate::sculpture::Grid;
use crate::surface::raycast;
use crate::tools::brush::footprint::{Coverage, Footprint, TouchedVoxel};

impl Footprint {
    /// Returns the voxels of `surface` that this footprint selects, each once.
    pub fn touched(&self, surface: &Grid) -> Vec<TouchedVoxel> {
        match self.coverage {
            Coverage::Rays => self.met_by_rays(surface),
            Coverage::Visible => visible::under(self, surface),
        }
    }

    /// Returns the voxels that the rays meet, each with its smallest offset.
    fn met_by_rays(&self, surface: &Grid) -> Vec<TouchedVoxel> {
        let reach = self.radius as i32;
        let mut seen = HashSet::new();
        let mut touched = Vec::new();
        // From the centre outwards, so that a voxel keeps its smallest offset.
        let mut rays: Vec<(f32, i32, i32)> = Vec::new();
        for j in -reach..=reach {
            for i in -reach..=reach {
                let distance = self.outline.distance(i as f32, j as f32);
                if distance <= self.radius {
                    rays.push((distance / self.radius.max(1.0), i, j));
                }
            }
        }
        rays.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (offset, i, j) in rays {
            let direction = self.aim + self.across * i as f32 + self.down * j as f32;
            if let Some(hit) = raycast::cast(surface, self.eye_vx, direction)
                && seen.insert(hit.voxel)
            {
                touched.push(TouchedVoxel { voxel: hit.voxel.as_ivec3(), offset });
            }
        }
        touched
    }
}

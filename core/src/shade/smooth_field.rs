//! The smooth surface of a whole sculpture, as shown in pictures, for meshes and other resolutions; it may be kept and
//! follow edits.
//!
//! Takes a grid and its changes; returns levels, and the bricks whose levels have changed. Knows no vertices.

use super::{LevelSet, NormalField};
use crate::progress::Progress;
use crate::sculpture::{Grid, GridError, Limits};

/// Portions of work between two progress reports.
const PORTIONS: usize = 16;

/// Normals and levels of a grid.
#[derive(Debug)]
pub(crate) struct SmoothField {
    normals: NormalField,
    levels: LevelSet,
}

impl SmoothField {
    /// Returns the surface of a grid of this size, within `limits`; all is outstanding.
    pub fn new(grid: &Grid, limits: &Limits) -> Result<SmoothField, GridError> {
        let levels = LevelSet::whole(grid, limits.grid_bytes)?;
        Ok(SmoothField { normals: NormalField::default(), levels })
    }

    pub fn levels(&self) -> &LevelSet {
        &self.levels
    }

    /// Returns the bytes in memory.
    pub fn heap_bytes(&self) -> u64 {
        self.normals.heap_bytes() + self.levels.heap_bytes()
    }

    /// Computes the surface of `grid`. `changed`: the bricks whose voxels differ from the last time, to which those
    /// whose levels differ are added; `None`: all may differ. Returns false if it was cancelled.
    #[must_use]
    pub fn update(
        &mut self,
        grid: &Grid,
        changed: Option<&mut Vec<u32>>,
        progress: &dyn Progress,
    ) -> bool {
        progress.begin("smoothing");
        let SmoothField { normals, levels } = self;
        normals.follow(grid, changed.as_deref().map(Vec::as_slice));
        if let Some(changed) = &changed {
            levels.follow(grid, changed);
        }
        let (mut reshaded, mut moved) = (Vec::new(), Vec::new());
        // Both have a portion for each brick; one of normals takes some four times as long.
        let all = (normals.outstanding() + levels.outstanding() / 4).max(1);
        let report = |normals: usize, levels: usize| {
            let left = (normals + levels / 4).min(all);
            progress.advance(1.0 - left as f32 / all as f32);
        };
        let go_on = |portions: &mut usize| {
            *portions += 1;
            *portions <= PORTIONS && !progress.is_cancelled()
        };
        loop {
            let mut portions = 0;
            normals.update(grid, &mut reshaded, || go_on(&mut portions));
            report(normals.outstanding(), levels.outstanding());
            if normals.outstanding() == 0 || progress.is_cancelled() {
                break;
            }
        }
        levels.follow(grid, &reshaded);
        while levels.outstanding() > 0 && !progress.is_cancelled() {
            let mut portions = 0;
            levels.update_while(grid, normals, &mut moved, || go_on(&mut portions));
            report(0, levels.outstanding());
        }
        progress.end();
        if progress.is_cancelled() {
            return false;
        }
        if let Some(changed) = changed {
            changed.append(&mut moved);
            changed.sort_unstable();
            changed.dedup();
        }
        true
    }
}

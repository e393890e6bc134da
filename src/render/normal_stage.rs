//! The normals of a renderer's pictures: their computation before a picture, the bricks to shade again, and the
//! device's copy.
//!
//! Follows the grid of one document. Normals that edits change are computed before the next picture; those of an opened
//! sculpture take as much of each picture's time as its caller allows, and estimates stand in for the rest. Where the
//! CPU shades index maps, only those of visible bricks are computed before a picture, or estimated if it must not be
//! delayed. The others follow while the view rests, or before anything else reads them; of a sculpture whose normals take
//! more memory than the bound, only those that pictures showed last are kept.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Normals, Shading};
use crate::gpu::{Device, Recorder, Result};
use crate::sculpture::Grid;
use crate::sculpture::brick::BRICK_EDGE_VX;
use crate::shade::{NormalField, Precision};
use crate::surface::{IndexMap, PixelRects, changed_pixels, pixels_of_grid};

/// The change of the normals since the last picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum NormalsChange {
    None,
    /// The normals of known bricks differ.
    Some,
    /// Any normals may differ.
    All,
}

/// See the module text.
#[derive(Default)]
pub(super) struct NormalStage {
    field: NormalField,
    /// Longest delay of a picture; `None`: until everything is computed.
    pub patience: Option<Duration>,
    /// About the most memory of normals, if there is a longest delay. Only with pictures that have index maps.
    pub limit_bytes: u64,
    /// The last picture has all normals that it shows, and no others are to be computed.
    is_settled: bool,
    /// Bricks that have changed, or have other normals, since the last picture, rising.
    reshaded: Vec<u32>,
    /// Exists only while a mode uses it.
    copy: Option<Normals>,
    /// The units written to the field since the last picture.
    written: Vec<u32>,
    /// The time that the last [`NormalStage::update`] took.
    pub took: Duration,
}

/// The distance in voxels that contains every voxel on which the normals of a changed brick's neighbours depend: two
/// bricks.
const REACH_VX: u32 = 2 * BRICK_EDGE_VX;

impl NormalStage {
    /// Computes normals for a picture of `grid`, whose changed bricks are these; `None`: all may have changed. `rests`:
    /// it shows the same as the last one, which had all the normals that it shows. Of an opened sculpture, those that
    /// the last pictures, with these maps, have shown come first.
    pub fn update(
        &mut self,
        grid: &Grid,
        changed: Option<&[u32]>,
        rests: bool,
        maps: &[Arc<IndexMap>],
    ) -> NormalsChange {
        let had_estimates = self.field.has_estimates();
        let (start, patience) = (Instant::now(), self.patience);
        let mut go_on = || patience.is_none_or(|patience| start.elapsed() < patience);
        self.field.set_limit(if patience.is_some() { self.limit_bytes } else { u64::MAX });
        self.field.follow(grid, changed);
        self.reshaded.clear();
        let stays = rests && self.is_settled && changed.is_some_and(<[u32]>::is_empty);
        if rests && self.field.deferred() > 0 {
            self.field.update_deferred(grid, &mut self.reshaded, go_on);
        } else {
            // Maps of another sculpture have other bricks.
            let has_maps = changed.is_some() && patience.is_some() && !stays;
            if has_maps && self.field.follows_pictures() {
                // Maps that stay on the device are empty here.
                let maps = maps.iter().map(|map| &**map).filter(|map| !map.voxels.is_empty());
                self.field.complete_seen(grid, maps, &mut self.reshaded, &mut go_on);
            }
            self.field.update(grid, &mut self.reshaded, &mut go_on);
        }
        self.is_settled = rests && self.field.is_settled();
        self.took = start.elapsed();
        self.finish(changed, had_estimates)
    }

    /// Returns whether [`NormalStage::update_seen`] will defer invisible bricks.
    pub fn can_defer(&self) -> bool {
        !self.field.has_backlog()
    }

    /// Returns whether the last picture has all normals, so that it will not become better.
    pub fn is_settled(&self) -> bool {
        self.is_settled || self.field.is_complete()
    }

    /// Returns whether bricks were deferred.
    pub fn has_deferred(&self) -> bool {
        self.field.deferred() > 0
    }

    /// Does [`NormalStage::update`] for pictures with these maps, sampled after the edit. Defers invisible normals.
    /// `moved`: the eyes have moved since the last pictures.
    pub fn update_seen(
        &mut self,
        grid: &Grid,
        changed: &[u32],
        maps: &[Arc<IndexMap>],
        moved: bool,
    ) -> NormalsChange {
        let start = Instant::now();
        let had_estimates = self.field.has_estimates();
        self.field.follow(grid, Some(changed));
        self.reshaded.clear();
        let pixels = |map: &IndexMap| match moved {
            true => PixelRects::of(pixels_of_grid(grid, &map.rays)),
            false => changed_pixels(grid, changed, &map.rays, REACH_VX),
        };
        let views = maps.iter().map(|map| (&**map, pixels(map)));
        let precision =
            if self.patience.is_some() { Precision::Estimated } else { Precision::Refined };
        self.field.update_seen(grid, views, precision, &mut self.reshaded);
        // If there are very many bricks, none is deferred.
        if self.field.has_backlog() {
            let patience = self.patience;
            self.field.update(grid, &mut self.reshaded, || {
                patience.is_none_or(|patience| start.elapsed() < patience)
            });
        }
        self.is_settled = false;
        self.took = start.elapsed();
        self.finish(Some(changed), had_estimates)
    }

    fn finish(&mut self, changed: Option<&[u32]>, had_estimates: bool) -> NormalsChange {
        let differ = !self.reshaded.is_empty();
        self.reshaded.extend_from_slice(changed.unwrap_or_default());
        self.reshaded.sort_unstable();
        self.reshaded.dedup();
        match differ {
            // Estimates appear or disappear everywhere.
            _ if had_estimates != self.field.has_estimates() => NormalsChange::All,
            true => NormalsChange::Some,
            false => NormalsChange::None,
        }
    }

    /// Updates the device's copy if `shading` uses it, or else drops it. Recorded in `recorder`, for frame `slot`,
    /// after [`NormalStage::update`] and once per frame.
    pub fn upload(
        &mut self,
        device: &Arc<Device>,
        recorder: &mut Recorder,
        slot: usize,
        grid: &Grid,
        shading: Shading,
    ) -> Result<()> {
        let field = &mut self.field;
        field.take_written(&mut self.written);
        match (shading, &mut self.copy) {
            (Shading::Software | Shading::Points, copy) => *copy = None,
            (Shading::Device | Shading::Within, Some(copy)) => {
                copy.update(recorder, slot, (grid, field), &self.written, &self.reshaded)?;
            }
            (Shading::Device | Shading::Within, none) => *none = Some(Normals::new(device, field)?),
        }
        Ok(())
    }

    /// Adds bricks to those to shade again.
    pub fn reshade(&mut self, bricks: &[u32]) {
        self.reshaded.extend_from_slice(bricks);
        self.reshaded.sort_unstable();
        self.reshaded.dedup();
    }

    pub fn field(&self) -> &NormalField {
        &self.field
    }

    /// Returns the field, for computing normals that are outstanding.
    pub fn field_mut(&mut self) -> &mut NormalField {
        &mut self.field
    }

    /// Returns the bricks to shade again.
    pub fn reshaded(&self) -> &[u32] {
        &self.reshaded
    }

    /// Returns the device's copy, after [`NormalStage::upload`] for a mode that uses it.
    pub fn copy(&self) -> Option<&Normals> {
        self.copy.as_ref()
    }
}

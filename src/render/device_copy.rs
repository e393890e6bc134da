//! The device's copy of a document: bits, colours and the areas of slices, each if a render mode needs it.
//!
//! Follows the changes of one document. Has frames of its own, in which it is updated and sampled; knows no pass.

use std::sync::Arc;

use super::{DeviceColours, MaskShown, RenderMode, Sampling, Volume};
use crate::document::{ChangeSubscriber, Document};
use crate::gpu::{Device, Frames, Recorder, Result, Timer};
use crate::surface::slices::SliceAreas;

/// The device's copy of a document, and the frames that update and sample it.
pub(super) struct DeviceCopy {
    pub volume: Volume,
    /// Only while they are needed.
    pub colours: Option<DeviceColours>,
    pub areas: Option<SliceAreas>,
    pub frames: Frames,
    /// Times of the sampling.
    pub timer: Option<Timer<1>>,
    /// Drains the bricks that change.
    subscriber: ChangeSubscriber,
    pub device: Arc<Device>,
}

impl DeviceCopy {
    /// Copies the bits of `document`.
    pub fn new(device: &Arc<Device>, document: &mut Document) -> Result<DeviceCopy> {
        // A new copy needs all bricks, whatever changes the document reports.
        let subscriber = ChangeSubscriber::default();
        let volume = document
            .drain_changes_for(&subscriber, |contents, _| Volume::new(device, &contents.grid))?;
        Ok(DeviceCopy {
            subscriber,
            volume,
            colours: None,
            areas: None,
            frames: Frames::new(device)?,
            timer: Timer::new(device, "times of sampling")?,
            device: device.clone(),
        })
    }

    /// Updates the parts that `mode` needs in the present frame, and drops the others.
    pub fn update(
        &mut self,
        recorder: &mut Recorder,
        document: &mut Document,
        mode: RenderMode,
        mask: Option<MaskShown>,
    ) -> Result<()> {
        let slot = self.frames.slot();
        document.drain_changes_for(&self.subscriber, |contents, changed| {
            let grid = &contents.grid;
            self.volume.update(recorder, slot, grid, changed)?;
            match &mut self.areas {
                _ if mode.sampling() != Sampling::Slicing => self.areas = None,
                Some(areas) => areas.update(grid, changed),
                none => none.insert(SliceAreas::default()).update(grid, None),
            }
            let needs_colours = mode.needs_colours() || (mode.shades_on_device() && mask.is_some());
            let shown = MaskShown::colours(mask, contents);
            match &mut self.colours {
                _ if !needs_colours => self.colours = None,
                Some(colours) => colours.update(recorder, slot, &shown, changed)?,
                none => *none = Some(DeviceColours::new(&self.device, &shown)?),
            }
            Ok(())
        })
    }
}

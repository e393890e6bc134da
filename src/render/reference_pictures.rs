//! Gives a renderer the reference pictures of its next pictures.
//!
//! Uploads what is new of them, and has all drawn again where they differ. The pass stands in `reference`.

use super::reference::{MAX_REFERENCES, ReferencePicture, References};
use super::renderer::Renderer;
use crate::gpu::{Recorder, Result};

impl Renderer {
    /// Takes the reference pictures of the next pictures, at most [`MAX_REFERENCES`]. Before [`Renderer::paint`], in
    /// the same frame. If this fails, there are none.
    pub fn set_references(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        pictures: &[ReferencePicture],
    ) -> Result<()> {
        let pictures = &pictures[..pictures.len().min(MAX_REFERENCES)];
        let shown = self.overlay.references.as_ref().map_or(&[][..], |known| &known.shown);
        if shown == pictures {
            return Ok(());
        }
        // All is drawn again: they may be anywhere.
        self.cache = None;
        let references = match self.overlay.references.take() {
            Some(references) => references,
            None => References::new(&self.device, self.format)?,
        };
        let references = self.overlay.references.insert(references);
        let result = references.bring(recorder, slot, pictures);
        if result.is_err() {
            self.overlay.references = None;
        }
        result
    }
}

//! The picture of the board: its interface in an image of its own, shown by the headset as a quad layer on the hand.

use std::sync::Arc;

use ash::vk;
use egui::epaint::ClippedShape;
use glam::UVec2;

use super::board_ui::BoardUi;
use crate::app::Workspace;
use crate::gpu::{Attachment, Device, EyeImage, GpuError, ImagePart, Load, Recorder, ResourceUse};
use crate::input::hands::HandEvent;
use crate::render::gui::{Gui, TextureChanges};
use crate::shade::Pixels;

const FORMAT: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// The board's interface and its picture. Fields are dropped in this order.
pub struct BoardPane {
    gui: Gui,
    picture: EyeImage,
    ui: BoardUi,
    device: Arc<Device>,
}

/// The output of a pass, to be drawn.
pub struct Pass {
    shapes: Vec<ClippedShape>,
    textures: TextureChanges,
}

impl BoardPane {
    /// Creates a board with a picture of `size_px` pixels.
    pub fn new(
        device: &Arc<Device>,
        size_px: UVec2,
        pixels_per_point: f32,
    ) -> Result<BoardPane, GpuError> {
        use vk::ImageUsageFlags as Usage;
        let usage = Usage::COLOR_ATTACHMENT | Usage::TRANSFER_SRC;
        let texture_limit = device.limits().max_image_dimension2_d as usize;
        Ok(BoardPane {
            gui: Gui::new(device, FORMAT)?,
            picture: EyeImage::new(device, "board", size_px, 1, FORMAT, usage)?,
            ui: BoardUi::new(size_px, pixels_per_point, texture_limit),
            device: device.clone(),
        })
    }

    /// Handles a controller event for the board.
    pub fn handle(&mut self, event: &HandEvent) {
        self.ui.handle(event);
    }

    /// Returns whether another pass is due at `now_s`.
    pub fn is_due(&self, now_s: f64) -> bool {
        self.ui.is_due(now_s)
    }

    /// Runs a pass of the interface and executes its requests on the workspace. With `says_only`, shows nothing but
    /// messages.
    pub fn pass(&mut self, workspace: &mut Workspace, now_s: f64, says_only: bool) -> Pass {
        let output = self.ui.pass(now_s, |root| match says_only {
            true => workspace.show_messages(root),
            false => workspace.show_on_board(root),
        });
        Pass { shapes: output.shapes, textures: output.textures_delta.into() }
    }

    /// Records the picture of a pass and leaves it in the layout of [`ResourceUse::COPY_SOURCE`]. `slot`:
    /// [`crate::gpu::Frames::slot`].
    pub fn draw(
        &mut self,
        recorder: &mut Recorder,
        slot: usize,
        pass: &mut Pass,
    ) -> Result<ImagePart, GpuError> {
        self.gui.upload(recorder, slot, &mut pass.textures)?;
        let context = self.ui.context();
        let points = context.pixels_per_point();
        let primitives = context.tessellate(std::mem::take(&mut pass.shapes), points);
        self.picture.begin_overwrite(recorder, 0, ResourceUse::COLOUR_TARGET);
        let view = self.picture.image().view();
        let attachment = Attachment { view, load: Load::Colour([0.0; 4]), store: true };
        let size = self.picture.size().to_array();
        recorder.begin_rendering(size, Some(attachment), None);
        self.gui.draw(recorder, size, points, primitives)?;
        recorder.end_rendering();
        self.picture.transition(recorder, 0, ResourceUse::COPY_SOURCE);
        Ok(self.picture.image().layer(0))
    }

    /// Returns the error, once, if memory was lacking for a part of the interface ([`Gui::take_lack`]).
    pub fn take_lack(&mut self) -> Option<GpuError> {
        self.gui.take_lack()
    }

    /// Called after the submission that draws a pass.
    pub fn submitted(&mut self, pass: &mut Pass) {
        self.gui.free(&mut pass.textures);
    }

    /// Reads the picture back. Waits for the device.
    pub fn read_back(&self) -> Result<Pixels, GpuError> {
        let image = self.picture.image();
        let bytes = crate::gpu::read_image_once(
            &self.device,
            image.layer(0),
            image.size(),
            4,
            ResourceUse::COPY_SOURCE,
        )?;
        Ok(Pixels { size: self.picture.size(), rgba: bytemuck::pod_collect_to_vec(&bytes) })
    }
}

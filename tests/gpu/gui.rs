//! The interface's textures are created, partly updated and freed within frames, without waiting.

use ash::vk;
use egui::epaint::{ClippedPrimitive, Color32, ImageDelta, Mesh, Primitive, Vertex};
use egui::{ColorImage, Rect, TextureId, TextureOptions, TexturesDelta, pos2};
use virtual_sculpture::gpu::{
    Attachment, Device, Frames, Image, ImageInfo, Load, ResourceUse, read_image_once,
};
use virtual_sculpture::render::gui::Gui;

use super::fixture::with_device;

const SIZE: [u32; 2] = [8, 8];
const RED: Color32 = Color32::from_rgb(255, 0, 0);
const GREEN: Color32 = Color32::from_rgb(0, 255, 0);

/// A texture over all of the target.
fn sheet(id: TextureId) -> Vec<ClippedPrimitive> {
    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(SIZE[0] as f32, SIZE[1] as f32));
    let corner = |x: f32, y: f32| Vertex {
        pos: pos2(x * whole.max.x, y * whole.max.y),
        uv: pos2(x, y),
        color: Color32::WHITE,
    };
    let mesh = Mesh {
        indices: vec![0, 1, 2, 2, 1, 3],
        vertices: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0)],
        texture_id: id,
    };
    vec![ClippedPrimitive { clip_rect: whole, primitive: Primitive::Mesh(mesh) }]
}

fn filled(side: usize, colour: Color32) -> ColorImage {
    ColorImage::filled([side, side], colour)
}

struct Stage<'a> {
    gui: Gui,
    frames: Frames,
    target: Image,
    drawn: bool,
    device: &'a std::sync::Arc<Device>,
}

impl Stage<'_> {
    /// A frame that shows a texture after a change.
    fn frame(&mut self, id: TextureId, mut delta: TexturesDelta) {
        let mut recorder = self.frames.begin().unwrap();
        self.gui.upload(&mut recorder, self.frames.slot(), &mut delta).unwrap();
        assert!(delta.set.is_empty());
        let before = if self.drawn { ResourceUse::COPY_SOURCE } else { ResourceUse::NOTHING };
        recorder.image_barrier(self.target.whole(), before, ResourceUse::COLOUR_TARGET);
        let colour =
            Attachment { view: self.target.view(), load: Load::Colour([0.0; 4]), store: true };
        recorder.begin_rendering(SIZE, Some(colour), None);
        self.gui.draw(&recorder, SIZE, 1.0, sheet(id)).unwrap();
        recorder.end_rendering();
        recorder.image_barrier(
            self.target.whole(),
            ResourceUse::COLOUR_TARGET,
            ResourceUse::COPY_SOURCE,
        );
        self.frames.submit(recorder, &[], &[]).unwrap();
        self.gui.free(&mut delta);
        self.drawn = true;
    }

    fn pixels(&self) -> Vec<[u8; 4]> {
        let size = [SIZE[0], SIZE[1], 1];
        let bytes =
            read_image_once(self.device, self.target.whole(), size, 4, ResourceUse::COPY_SOURCE)
                .unwrap();
        bytemuck::pod_collect_to_vec(&bytes)
    }
}

fn change(id: TextureId, delta: ImageDelta) -> TexturesDelta {
    let mut changes = TexturesDelta::default();
    changes.set.entry(id).or_default().push(delta);
    changes
}

#[test]
fn textures_are_made_changed_in_part_and_replaced_while_frames_are_in_flight() {
    with_device(|device| {
        let format = vk::Format::R8G8B8A8_UNORM;
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC;
        let info = ImageInfo::plane("target", SIZE, format, usage);
        let mut stage = Stage {
            gui: Gui::new(device, format).unwrap(),
            frames: Frames::new(device).unwrap(),
            target: Image::new(device, &info).unwrap(),
            drawn: false,
            device,
        };
        let id = TextureId::Managed(0);
        let options = TextureOptions::NEAREST;
        stage.frame(id, change(id, ImageDelta::full(filled(8, RED), options)));
        assert_eq!(stage.pixels(), [[255, 0, 0, 255]; 64]);

        // A quarter of it is another colour; the rest stays.
        stage.frame(id, change(id, ImageDelta::partial([4, 4], filled(4, GREEN), options)));
        let pixels = stage.pixels();
        assert_eq!((pixels[0], pixels[63]), ([255, 0, 0, 255], [0, 255, 0, 255]));
        stage.frame(id, TexturesDelta::default());
        assert_eq!(stage.pixels(), pixels, "and it stays in the next frame");

        // Other sizes, as a font's sheet grows, each while the frame before is in flight; and a
        // texture that is freed while it is shown.
        for side in [16, 32, 64, 8] {
            stage.frame(id, change(id, ImageDelta::full(filled(side, GREEN), options)));
            let other = TextureId::Managed(side as u64);
            let mut once = change(other, ImageDelta::full(filled(side, RED), options));
            once.free.insert(other);
            stage.frame(other, once);
        }
        assert_eq!(stage.pixels(), [[255, 0, 0, 255]; 64]);
        stage.frame(id, TexturesDelta::default());
        assert_eq!(stage.pixels(), [[0, 255, 0, 255]; 64]);

        // An invalid update is an error and has no other effect.
        let beyond = ImageDelta::partial([7, 7], filled(4, RED), options);
        let unknown = ImageDelta::partial([0, 0], filled(1, RED), options);
        for mut delta in [change(id, beyond), change(TextureId::Managed(99), unknown)] {
            let mut recorder = stage.frames.begin().unwrap();
            let slot = stage.frames.slot();
            assert!(stage.gui.upload(&mut recorder, slot, &mut delta).is_err());
        }
        stage.frame(id, TexturesDelta::default());
        assert_eq!(stage.pixels(), [[0, 255, 0, 255]; 64]);
    });
}

//! Screenshots of what the eyes see, written to a folder at intervals: for tests, and for developers
//! without a headset.
//!
//! Writes `left.png`, `right.png`, `board.png` while the board is open, and last `views.toml` with the
//! poses of the eyes. Each file replaces the former one atomically.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use serde::Serialize;

use crate::format::store::write_atomically;
use crate::shade::Pixels;
use crate::view::{Room, RoomView};

/// Seconds between two screenshots.
const INTERVAL_S: f64 = 0.25;

/// Writes screenshots.
pub struct EyeScreenshots {
    folder: PathBuf,
    number: u64,
    due_s: f64,
}

/// The contents of `views.toml`.
#[derive(Serialize)]
struct Views {
    /// Counts the screenshots.
    number: u64,
    /// The left, then the right eye, in metres of the room.
    eye: Vec<EyeText>,
    /// The world of the sculpture in the room.
    world: WorldText,
}

#[derive(Serialize)]
struct EyeText {
    position: [f32; 3],
    /// A quaternion, w last.
    rotation: [f32; 4],
    /// Tangents of the half angles: left, right, down, up.
    tangents: [f32; 4],
}

#[derive(Serialize)]
struct WorldText {
    position: [f32; 3],
    rotation: [f32; 4],
    metres_per_unit: f32,
}

impl EyeScreenshots {
    pub fn new(folder: PathBuf) -> EyeScreenshots {
        EyeScreenshots { folder, number: 0, due_s: 0.0 }
    }

    pub fn is_due(&self, now_s: f64) -> bool {
        now_s >= self.due_s
    }

    /// Writes a screenshot.
    pub fn write(
        &mut self,
        now_s: f64,
        eyes: &[Pixels],
        board: Option<&Pixels>,
        views: &[RoomView; 2],
        room: &Room,
    ) -> std::io::Result<()> {
        self.due_s = now_s + INTERVAL_S;
        self.number += 1;
        std::fs::create_dir_all(&self.folder)?;
        for (name, pixels) in ["left.png", "right.png"].into_iter().zip(eyes) {
            write_png(&self.folder.join(name), pixels)?;
        }
        if let Some(board) = board {
            write_png(&self.folder.join("board.png"), board)?;
        }
        let eye = views.iter().map(|view| EyeText {
            position: view.pose.position.into(),
            rotation: view.pose.rotation.into(),
            tangents: {
                let f = view.frustum;
                [f.left, f.right, f.down, f.up]
            },
        });
        let world = room.room_from_world;
        let views = Views {
            number: self.number,
            eye: eye.collect(),
            world: WorldText {
                position: world.translation.into(),
                rotation: world.rotation.into(),
                metres_per_unit: world.scale,
            },
        };
        let text = toml::to_string(&views).map_err(std::io::Error::other)?;
        write_atomically(&self.folder.join("views.toml"), text.as_bytes())
    }
}

fn write_png(path: &Path, pixels: &Pixels) -> std::io::Result<()> {
    let mut png = Cursor::new(Vec::new());
    PngEncoder::new(&mut png)
        .write_image(pixels.bytes(), pixels.size.x, pixels.size.y, ExtendedColorType::Rgba8)
        .map_err(std::io::Error::other)?;
    write_atomically(path, png.get_ref())
}

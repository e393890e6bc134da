//! A picture in memory.

use glam::UVec2;

/// Pixels of 8-bit sRGB and linear alpha, row by row from the top.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Pixels {
    /// Width and height in pixels.
    pub size: UVec2,
    /// `size.x * size.y` values.
    pub rgba: Vec<[u8; 4]>,
}

impl Pixels {
    /// Returns a transparent picture.
    pub fn new(size: UVec2) -> Pixels {
        let mut pixels = Pixels::default();
        pixels.reset(size);
        pixels
    }

    /// Changes the size of the picture, keeping its memory. The values are left as they are.
    pub fn reset(&mut self, size: UVec2) {
        self.size = size;
        self.rgba.resize(size.x as usize * size.y as usize, [0; 4]);
    }

    /// Returns the bytes of all pixels, in the form of files and textures.
    pub fn bytes(&self) -> &[u8] {
        self.rgba.as_flattened()
    }
}

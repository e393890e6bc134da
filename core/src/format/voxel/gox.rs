//! Reads Goxel's `.gox`: chunks of blocks of 16^3 voxels, each stored as a PNG of 64x64 pixels, and of layers that
//! say where blocks stand. z points up.

use std::io::Cursor;

use glam::I64Vec3;
use image::{ImageFormat, ImageReader, Limits};

use super::{Model, Sink, upright};
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::format::error::excerpt;
use crate::sculpture::Rgb;
use crate::sculpture::orientation::Up;

/// Voxels along the edge of a block, and pixels along that of its picture.
const EDGE_VX: i64 = 16;
const PICTURE_EDGE: u32 = 64;
/// The newest version that is known.
const VERSION: u32 = 2;
/// Voxels of this opacity or more exist, as Goxel draws them.
const OPAQUE: u8 = 128;

/// A file.
#[derive(Debug)]
pub struct Gox<'a> {
    version: u32,
    blocks: Vec<Bytes<'a>>,
    layers: Vec<Layer>,
    hidden: usize,
}

#[derive(Debug, Default)]
struct Layer {
    /// Number and lower corner of each of its blocks.
    placed: Vec<(usize, I64Vec3)>,
    is_hidden: bool,
}

/// Reads the structure of a file.
pub fn read(file: &[u8]) -> Result<Gox<'_>, FormatError> {
    let mut bytes = Bytes::new(file);
    if !file.starts_with(b"GOX ") {
        let begin = excerpt(file);
        return Err(bytes.fault(format!("the file begins with `{begin}`, as no Goxel file does")));
    }
    bytes.take(4)?;
    let start = bytes;
    let version = bytes.u32()?;
    if version > VERSION {
        return Err(start.fault(format!("version {version} is not known, only 1 and {VERSION}")));
    }
    let mut gox = Gox { version, blocks: Vec::new(), layers: Vec::new(), hidden: 0 };
    while !bytes.is_empty() {
        let id = bytes.take(4)?;
        let length = bytes.count("bytes")?;
        let chunk = bytes.part(length)?;
        // A checksum that Goxel itself leaves 0.
        bytes.u32()?;
        match id {
            b"BL16" => gox.blocks.push(chunk),
            b"LAYR" => gox.layers.push(layer(chunk)?),
            _ => {}
        }
    }
    gox.hidden = gox.layers.iter().filter(|layer| layer.is_hidden).count();
    gox.layers.retain(|layer| !layer.is_hidden);
    for (number, _) in gox.layers.iter().flat_map(|layer| &layer.placed) {
        if *number >= gox.blocks.len() {
            let there = gox.blocks.len();
            return Err(bytes.fault(format!("a layer names block {number}, but there are {there}")));
        }
    }
    Ok(gox)
}

fn layer(mut chunk: Bytes<'_>) -> Result<Layer, FormatError> {
    let mut layer = Layer::default();
    for _ in 0..chunk.count("blocks")? {
        let number = chunk.count("as the number of a block")?;
        let corner = [chunk.i32()?, chunk.i32()?, chunk.i32()?].map(i64::from);
        chunk.u32()?;
        layer.placed.push((number, I64Vec3::from_array(corner)));
    }
    // Names and values; a name without length ends them.
    while !chunk.is_empty() {
        let length = chunk.count("bytes")?;
        if length == 0 {
            break;
        }
        let name = chunk.take(length)?;
        let length = chunk.count("bytes")?;
        let value = chunk.take(length)?;
        if name == b"visible" {
            layer.is_hidden = value.iter().all(|byte| *byte == 0);
        }
    }
    Ok(layer)
}

/// The voxels of a block, x fastest, then y, then z.
fn decode(block: &Bytes<'_>) -> Result<Vec<[u8; 4]>, FormatError> {
    let fault = |error: String| block.fault(format!("the block's picture cannot be read: {error}"));
    let mut limits = Limits::default();
    limits.max_image_width = Some(PICTURE_EDGE);
    limits.max_image_height = Some(PICTURE_EDGE);
    limits.max_alloc = Some(1 << 20);
    let mut reader = ImageReader::with_format(Cursor::new(block.rest()), ImageFormat::Png);
    reader.limits(limits);
    let picture = reader.decode().map_err(|error| fault(error.to_string()))?.into_rgba8();
    if picture.dimensions() != (PICTURE_EDGE, PICTURE_EDGE) {
        let (width, height) = picture.dimensions();
        return Err(fault(format!("it has {width}x{height} pixels instead of 64x64")));
    }
    Ok(picture.pixels().map(|pixel| pixel.0).collect())
}

impl Model for Gox<'_> {
    fn kind(&self) -> String {
        format!("Goxel, version {}, layers: {}", self.version, self.layers.len())
    }

    /// Goxel stores whole blocks, so the edges of their boxes mean nothing.
    fn up(&self) -> Up {
        Up::Z
    }

    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)> {
        None
    }

    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError> {
        for (number, corner) in self.layers.iter().flat_map(|layer| &layer.placed) {
            for (i, [r, g, b, opacity]) in (0..).zip(decode(&self.blocks[*number])?) {
                if opacity >= OPAQUE {
                    let place =
                        I64Vec3::new(i % EDGE_VX, i / EDGE_VX % EDGE_VX, i / EDGE_VX / EDGE_VX);
                    sink(upright(corner + place), Rgb([r, g, b]))?;
                }
            }
        }
        Ok(())
    }

    fn notes(&self) -> Vec<String> {
        let hidden = self.hidden;
        let note = |_| format!("{hidden} hidden layers were left out");
        (hidden > 0).then_some(()).map(note).into_iter().collect()
    }
}

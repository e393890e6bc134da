//! Reads Goxel's `.gox`: chunks of blocks of 16^3 voxels, each stored as a PNG of 64x64 pixels, and of layers that
//! position blocks; `gox_layer.rs` makes voxels of them. z points up.

use std::io::Cursor;

use glam::I64Vec3;
use image::{ImageFormat, ImageReader, Limits};

use super::gox_layer::{self, GoxLayer};
use super::model::{Model, ModelReader, Sink};
use crate::format::FormatError;
use crate::format::bytes::Bytes;
use crate::format::error::excerpt;
use crate::format::spec::{FormatSpec, Import, Sign};
use crate::sculpture::history::SurfaceKind;
use crate::sculpture::orientation::Up;

pub static SPEC: FormatSpec = FormatSpec {
    signs: &[Sign::At(0, MAGIC)],
    ..FormatSpec::new(
        "a Goxel model",
        &["gox"],
        Import::Model(ModelReader {
            read: |file| Ok(Box::new(read(file)?)),
            surface: SurfaceKind::Cubes,
        }),
    )
};

const MAGIC: &[u8] = b"GOX ";
/// Edge of a block's picture in pixels.
const PICTURE_EDGE: u32 = 64;
/// The newest known version.
const VERSION: u32 = 2;

/// A file.
#[derive(Debug)]
struct Gox<'a> {
    version: u32,
    blocks: Vec<Bytes<'a>>,
    /// All layers, including hidden ones, which others may copy.
    layers: Vec<GoxLayer>,
}

/// Reads the structure of a file.
fn read(file: &[u8]) -> Result<Gox<'_>, FormatError> {
    let mut bytes = Bytes::new(file);
    if !file.starts_with(MAGIC) {
        let begin = excerpt(file);
        return Err(bytes.fault(format!("the file begins with `{begin}`, as no Goxel file does")));
    }
    bytes.take(MAGIC.len())?;
    let start = bytes;
    let version = bytes.u32()?;
    if version > VERSION {
        return Err(start.fault(format!("version {version} is not known, only 1 and {VERSION}")));
    }
    let mut gox = Gox { version, blocks: Vec::new(), layers: Vec::new() };
    while !bytes.is_empty() {
        let id = bytes.take(4)?;
        let length = bytes.count("bytes")?;
        let chunk = bytes.part(length)?;
        // A checksum, which Goxel itself leaves 0.
        bytes.u32()?;
        match id {
            b"BL16" => gox.blocks.push(chunk),
            b"LAYR" => gox.layers.push(gox_layer::read(chunk)?),
            _ => {}
        }
    }
    for (number, _) in gox.layers.iter().flat_map(|layer| &layer.placed) {
        if *number >= gox.blocks.len() {
            let there = gox.blocks.len();
            return Err(bytes.fault(format!("a layer names block {number}, but there are {there}")));
        }
    }
    Ok(gox)
}

/// Returns the voxels of a block, x fastest, then y, then z.
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

impl Gox<'_> {
    fn visible(&self) -> impl Iterator<Item = &GoxLayer> {
        self.layers.iter().filter(|layer| !layer.is_hidden)
    }
}

impl Model for Gox<'_> {
    fn kind(&self) -> String {
        format!("Goxel, version {}, layers: {}", self.version, self.visible().count())
    }

    /// Goxel stores whole blocks, so the edges of their boxes have no meaning.
    fn up(&self) -> Up {
        Up::Z
    }

    fn canvas(&self) -> Option<(I64Vec3, I64Vec3)> {
        None
    }

    fn walk(&self, sink: &mut Sink<'_>) -> Result<(), FormatError> {
        let decoded = |number: usize| decode(&self.blocks[number]);
        self.visible().try_for_each(|layer| gox_layer::walk(layer, &self.layers, &decoded, sink))
    }

    fn notes(&self) -> Vec<String> {
        let hidden = self.layers.len() - self.visible().count();
        let note = (hidden > 0).then(|| format!("{hidden} hidden layers were left out"));
        let shapes = self.visible().filter_map(|layer| layer.unknown_shape.as_ref());
        let shapes =
            shapes.map(|shape| format!("a layer of the unknown shape `{shape}` was left out"));
        note.into_iter().chain(shapes).collect()
    }
}

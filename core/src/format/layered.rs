//! Volumes that are too large to be held: their voxels are read layer by layer along z, as often as they are needed.
//!
//! Takes the places of the voxels in files, or a decoder of layers; gives layers in the samples of a volume. Holds a few
//! layers at a time. Knows no format.

use std::fmt::Debug;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::Arc;

use bzip2::read::MultiBzDecoder;
use flate2::read::{MultiGzDecoder, ZlibDecoder};
use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::options::ScanRegion;
use super::scan::numbers::Number;
use super::scan::unpack::{cut, malformed};
use super::volume::{Samples, Texts, Volume};
use super::{FormatError, go_on};
use crate::progress::Progress;

/// The most bytes of layers that are read at once where a reader can take any number.
const PORTION_BYTES: u64 = 64 << 20;
/// Layers that are read at once at most, and where a reader needs those of whole bricks.
const PORTION_LAYERS: u32 = 8;

/// The packing of a part of the voxels.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PartPacking {
    Plain,
    Gzip,
    Bzip2,
    Zlib,
}

/// A file with a part of the voxels.
#[derive(Clone, PartialEq, Debug)]
pub struct VoxelPart {
    pub path: PathBuf,
    pub packing: PartPacking,
    /// Where the packed bytes begin in the file.
    pub packed_at: u64,
    /// Where the part begins, in bytes after unpacking; in the file if it is not packed.
    pub begin: u64,
    /// Its length in bytes after unpacking.
    pub bytes: u64,
}

/// The voxels of a volume in one or several files, x fastest, then y, then z.
#[derive(Clone, PartialEq, Debug)]
pub struct StoredVoxels {
    pub parts: Vec<VoxelPart>,
    /// Bytes of the parts before the voxels.
    pub skip: u64,
    pub numbers: StoredNumbers,
}

/// Decodes the layers of a volume one by one, in any order, also several at a time.
pub trait LayerDecoder: Debug + Send + Sync {
    /// Returns the numbers of a layer along z, x fastest, then y.
    fn layer(&self, z: u32) -> Result<Vec<u8>, FormatError>;
}

/// Where the layers of a volume come from.
#[derive(Clone, Debug)]
enum LayerSource {
    /// Files with the voxels, and the bytes before those.
    Parts(Vec<VoxelPart>, u64),
    Decoder(Arc<dyn LayerDecoder>),
}

/// How the numbers of a volume are stored.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StoredNumbers {
    pub number: Number,
    pub is_big: bool,
    /// Each number counts times the first plus the second.
    pub scale: [f64; 2],
}

/// A volume whose voxels stay in their files.
#[derive(Clone, Debug)]
pub struct LayeredVolume {
    /// Size in voxels, of the region if there is one.
    pub dims: UVec3,
    /// Edge lengths of a voxel.
    pub voxel_size: Vec3,
    /// Type of a voxel's value.
    pub samples: Samples,
    /// The texts stored with it.
    pub texts: Texts,
    source: LayerSource,
    stored: StoredNumbers,
    /// The size in the files, and the lowest voxel of the region.
    whole: UVec3,
    low: UVec3,
}

/// Receives the z of the first and the bytes of some layers.
type TakeLayers<'a> = &'a mut dyn FnMut(u32, &[u8]) -> Result<(), FormatError>;

/// How many layers a reader takes at once.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Portions {
    /// As many as memory allows, a power of two up to those of a brick.
    Any,
    /// Those of a layer of bricks.
    Bricks,
}

impl LayeredVolume {
    /// Describes a volume of `dims` voxels. Reads them once where their samples depend on their values. An error if a
    /// file is too short for its part.
    pub fn new(
        stored: StoredVoxels,
        dims: UVec3,
        voxel_size: Vec3,
        description: Vec<u8>,
        progress: &dyn Progress,
    ) -> Result<LayeredVolume, FormatError> {
        let StoredVoxels { parts, skip, numbers } = stored;
        for part in parts.iter().filter(|part| part.packing == PartPacking::Plain) {
            let found = super::store::open(&part.path)?.metadata()?.len();
            if found.checked_sub(part.begin).is_none_or(|bytes| bytes < part.bytes) {
                return Err(cut(part.bytes, found.saturating_sub(part.begin)));
            }
        }
        let source = LayerSource::Parts(parts, skip);
        LayeredVolume::of(source, numbers, (dims, voxel_size), description, progress)
    }

    /// Describes a volume of `dims` voxels whose layers are decoded. Reads them once where their samples depend on their
    /// values.
    pub fn decoded(
        decoder: Arc<dyn LayerDecoder>,
        numbers: StoredNumbers,
        (dims, voxel_size): (UVec3, Vec3),
        description: Vec<u8>,
        progress: &dyn Progress,
    ) -> Result<LayeredVolume, FormatError> {
        let source = LayerSource::Decoder(decoder);
        LayeredVolume::of(source, numbers, (dims, voxel_size), description, progress)
    }

    fn of(
        source: LayerSource,
        stored: StoredNumbers,
        (dims, voxel_size): (UVec3, Vec3),
        description: Vec<u8>,
        progress: &dyn Progress,
    ) -> Result<LayeredVolume, FormatError> {
        let texts = Texts { description, ..Texts::default() };
        let samples = Samples::F32Le;
        let (whole, low) = (dims, UVec3::ZERO);
        let mut volume =
            LayeredVolume { dims, voxel_size, samples, texts, source, stored, whole, low };
        let StoredNumbers { number, is_big, scale } = stored;
        volume.samples = match number.samples_unless_small(is_big, scale) {
            Some(samples) => samples,
            None => {
                let mut range = (f64::INFINITY, f64::NEG_INFINITY);
                volume.for_each_stored(Portions::Any, progress, &mut |_, data| {
                    let (least, most) = number.range(data, is_big, scale);
                    range = (range.0.min(least), range.1.max(most));
                    Ok(())
                })?;
                Number::samples_of_range(range)
            }
        };
        Ok(volume)
    }

    /// Keeps a box of voxels, which must lie in the volume.
    pub fn cut(&mut self, region: ScanRegion) {
        self.low += region.low;
        self.dims = region.dims();
    }

    /// Returns the bytes of all voxels.
    pub fn bytes(&self) -> u64 {
        self.dims.as_u64vec3().element_product() * u64::from(self.samples.bytes())
    }

    /// Returns the bytes that reading takes at a time.
    pub fn portion_bytes(&self, portions: Portions) -> u64 {
        let stored = self.stored_layer_bytes();
        let own = self.dims.x as u64 * self.dims.y as u64 * u64::from(self.samples.bytes());
        u64::from(self.count(portions)) * (stored + own)
    }

    /// Returns the layers that are read at once.
    fn count(&self, portions: Portions) -> u32 {
        let fitting = (PORTION_BYTES / self.stored_layer_bytes().max(1))
            .clamp(1, u64::from(PORTION_LAYERS)) as u32;
        match portions {
            Portions::Any => 1 << fitting.ilog2(),
            Portions::Bricks => PORTION_LAYERS,
        }
    }

    /// Reads all layers in order.
    pub fn for_each(
        &self,
        portions: Portions,
        progress: &dyn Progress,
        f: TakeLayers,
    ) -> Result<(), FormatError> {
        let StoredNumbers { number, is_big, scale } = self.stored;
        let mut converted = Vec::new();
        self.for_each_stored(portions, progress, &mut |z, data| {
            if number.is_kept(scale) && number.same(is_big).is_some() {
                return f(z, data);
            }
            converted.clear();
            number.convert(data, is_big, scale, self.samples, &mut converted);
            f(z, &converted)
        })
    }

    /// Performs [`LayeredVolume::for_each`] with the numbers as they are stored.
    fn for_each_stored(
        &self,
        portions: Portions,
        progress: &dyn Progress,
        f: TakeLayers,
    ) -> Result<(), FormatError> {
        let layer_bytes = self.stored_layer_bytes();
        let mut reader = match &self.source {
            LayerSource::Decoder(decoder) => LayerReader::Decoder(&**decoder),
            LayerSource::Parts(parts, skip) => {
                let mut reader = PartsReader::new(parts);
                reader.skip(skip + layer_bytes * u64::from(self.low.z))?;
                LayerReader::Parts(reader)
            }
        };
        let count = self.count(portions);
        let mut layers = vec![0; (layer_bytes * u64::from(count)) as usize];
        for z in (0..self.dims.z).step_by(count as usize) {
            go_on(progress)?;
            progress.advance(z as f32 / self.dims.z as f32);
            let count = count.min(self.dims.z - z);
            let whole = &mut layers[..(layer_bytes * u64::from(count)) as usize];
            match &mut reader {
                LayerReader::Parts(reader) => reader.fill(whole)?,
                LayerReader::Decoder(decoder) => {
                    decode(*decoder, self.low.z + z, layer_bytes as usize, whole)?;
                }
            }
            let kept = self.cropped(whole, count);
            f(z, &whole[..kept])?;
        }
        Ok(())
    }

    /// Returns the bytes of a layer as it is stored.
    fn stored_layer_bytes(&self) -> u64 {
        u64::from(self.whole.x) * u64::from(self.whole.y) * self.stored.number.bytes()
    }

    /// Moves the voxels of the region to the front of `count` layers. Returns their bytes.
    fn cropped(&self, layers: &mut [u8], count: u32) -> usize {
        let bytes = self.stored.number.bytes() as usize;
        if self.dims.truncate() == self.whole.truncate() {
            return layers.len();
        }
        let row = self.dims.x as usize * bytes;
        let mut at = 0;
        for z in 0..count {
            for y in self.low.y..self.low.y + self.dims.y {
                let row_before = y as usize + self.whole.y as usize * z as usize;
                let from = (self.low.x as usize + self.whole.x as usize * row_before) * bytes;
                layers.copy_within(from..from + row, at);
                at += row;
            }
        }
        at
    }

    /// Reads all voxels to memory.
    pub fn held(self, progress: &dyn Progress) -> Result<Volume, FormatError> {
        let mut data = Vec::with_capacity(self.bytes() as usize);
        progress.begin("reading");
        let read = self.for_each(Portions::Any, progress, &mut |_, layers| {
            data.extend_from_slice(layers);
            Ok(())
        });
        progress.end();
        read?;
        let LayeredVolume { dims, voxel_size, samples, texts, .. } = self;
        Ok(Volume { dims, voxel_size, samples, data, texts })
    }
}

/// A source that is being read.
enum LayerReader<'a> {
    Parts(PartsReader<'a>),
    Decoder(&'a dyn LayerDecoder),
}

/// Decodes layers of `bytes` bytes from `first` on, on all threads.
fn decode(
    decoder: &dyn LayerDecoder,
    first: u32,
    bytes: usize,
    layers: &mut [u8],
) -> Result<(), FormatError> {
    layers.par_chunks_exact_mut(bytes).enumerate().try_for_each(|(i, target)| {
        let layer = decoder.layer(first + i as u32)?;
        if layer.len() != bytes {
            return Err(cut(bytes as u64, layer.len() as u64));
        }
        target.copy_from_slice(&layer);
        Ok(())
    })
}

/// Reads parts one after the other.
struct PartsReader<'a> {
    parts: &'a [VoxelPart],
    /// The part that is open, and what is left of it.
    open: Option<(Box<dyn Read>, u64)>,
    /// The bytes read and skipped so far.
    done: u64,
    all: u64,
}

impl<'a> PartsReader<'a> {
    fn new(parts: &'a [VoxelPart]) -> PartsReader<'a> {
        let all = parts.iter().map(|part| part.bytes).sum();
        PartsReader { parts, open: None, done: 0, all }
    }

    /// Skips bytes. Whole parts are not opened.
    fn skip(&mut self, mut bytes: u64) -> Result<(), FormatError> {
        while bytes > 0 {
            if let Some((reader, rest)) = &mut self.open {
                let now = bytes.min(*rest);
                let found = io::copy(&mut reader.take(now), &mut io::sink()).map_err(damaged)?;
                self.advance(found);
                if found < now {
                    return Err(self.ended());
                }
                bytes -= now;
                continue;
            }
            let Some((part, after)) = self.parts.split_first() else { return Err(self.ended()) };
            if part.bytes <= bytes {
                (self.parts, bytes) = (after, bytes - part.bytes);
                self.done += part.bytes;
            } else if part.packing == PartPacking::Plain {
                self.open_next(bytes)?;
                self.done += bytes;
                bytes = 0;
            } else {
                self.open_next(0)?;
            }
        }
        Ok(())
    }

    /// Reads as many bytes as `buffer` has.
    fn fill(&mut self, mut buffer: &mut [u8]) -> Result<(), FormatError> {
        while !buffer.is_empty() {
            let Some((reader, rest)) = &mut self.open else {
                self.open_next(0)?;
                continue;
            };
            let now = (buffer.len() as u64).min(*rest) as usize;
            let mut found = 0;
            while found < now {
                match reader.read(&mut buffer[found..now]) {
                    Ok(0) => break,
                    Ok(count) => found += count,
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                    Err(error) => return Err(damaged(error)),
                }
            }
            self.advance(found as u64);
            if found < now {
                return Err(self.ended());
            }
            buffer = &mut buffer[now..];
        }
        Ok(())
    }

    /// Counts bytes of the open part, and closes it at its end.
    fn advance(&mut self, bytes: u64) {
        self.done += bytes;
        if let Some((_, rest)) = &mut self.open {
            *rest -= bytes;
            if *rest == 0 {
                self.open = None;
            }
        }
    }

    /// Opens the next part, at a number of bytes after its begin.
    fn open_next(&mut self, at: u64) -> Result<(), FormatError> {
        let Some((part, after)) = self.parts.split_first() else { return Err(self.ended()) };
        self.parts = after;
        let mut file = super::store::open(&part.path)?;
        file.seek(SeekFrom::Start(part.packed_at))?;
        let begin = part.begin + at;
        let unpacking = |mut reader: Box<dyn Read>| -> Result<Box<dyn Read>, FormatError> {
            io::copy(&mut reader.by_ref().take(begin), &mut io::sink()).map_err(damaged)?;
            Ok(reader)
        };
        let reader: Box<dyn Read> = match part.packing {
            PartPacking::Plain => {
                file.seek(SeekFrom::Start(begin))?;
                Box::new(file)
            }
            PartPacking::Gzip => unpacking(Box::new(MultiGzDecoder::new(buffered(file))))?,
            PartPacking::Bzip2 => unpacking(Box::new(MultiBzDecoder::new(buffered(file))))?,
            PartPacking::Zlib => unpacking(Box::new(ZlibDecoder::new(buffered(file))))?,
        };
        self.open = Some((reader, part.bytes - at));
        Ok(())
    }

    fn ended(&self) -> FormatError {
        cut(self.all, self.done)
    }
}

fn buffered(file: File) -> io::BufReader<File> {
    io::BufReader::with_capacity(1 << 20, file)
}

fn damaged(error: io::Error) -> FormatError {
    malformed("the voxels", error.to_string())
}

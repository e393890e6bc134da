//! The pixels of a series as a volume: all slices in memory, or each read from its file when it is needed.
//!
//! Takes the files and the planes of the layers; gives their numbers, scaled, without padding.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::super::numbers::Number;
use super::super::reading::{Reading, ScanVolume};
use super::data_set::{self, DataSet, ReadExtent};
use super::frames;
use super::padding::Padding;
use super::pixels::PixelLayout;
use super::plane::{FrameData, FramePlane};
use super::tags;
use crate::format::layered::{LayerDecoder, LayeredVolume, StoredNumbers};
use crate::format::{FormatError, Samples, budget_bytes, go_on, store};

/// Files that are examined between two looks at the progress.
const FILES_AT_ONCE: usize = 32;

/// The slices of a series, from the lowest layer to the highest.
pub struct SeriesSlices<'a> {
    pub files: &'a [PathBuf],
    pub planes: &'a [FramePlane],
    pub layout: PixelLayout,
    pub padding: Option<Padding>,
    pub dims: UVec3,
    pub reading: &'a Reading<'a>,
}

/// The slices in memory.
pub struct HeldSlices {
    pub samples: (Samples, Vec<u8>),
    pub file_bytes: u64,
    /// Whether padding was replaced.
    pub is_filled: bool,
}

impl SeriesSlices<'_> {
    /// Returns whether the slices should stay in their files: they are many, and large together.
    pub fn may_stay(&self) -> bool {
        self.files.len() > 1 && self.reading.is_large(self.layout.number.volume_bytes(self.dims))
    }

    /// Reads all slices. `first` is the first file.
    pub fn held(&self, first: Vec<u8>) -> Result<HeldSlices, FormatError> {
        let number = self.layout.number;
        let (mut stack, mut file_bytes) = (FrameStack::default(), 0);
        let mut add = |file: &[u8], planes: &[FramePlane]| {
            file_bytes += file.len() as u64;
            let rest_bytes = self.reading.rest_bytes(file.len() as u64);
            let whole = number.check(self.dims, rest_bytes)?;
            decode(file, planes, &self.layout, rest_bytes, &mut |frame, scale| {
                go_on(self.reading.progress)?;
                if stack.count == 0 {
                    stack.data.reserve_exact(whole as usize);
                }
                stack.add(frame, number, scale);
                self.reading.progress.advance(stack.count as f32 / self.dims.z as f32);
                Ok(())
            })
        };
        match self.files.len() {
            1 => add(&first, self.planes)?,
            _ => {
                drop(first);
                for planes in by_file(self.planes) {
                    add(&self.reading.read(&self.files[planes[0].file])?, planes)?;
                }
            }
        }
        let mut is_filled = false;
        if let Some(padding) = self.padding.filter(|_| !stack.is_scaled)
            && let (true, Some(least)) = padding.find(&stack.data, number)
        {
            padding.replace(&mut stack.data, number, least);
            is_filled = true;
        }
        Ok(HeldSlices { samples: stack.into_samples(number), file_bytes, is_filled })
    }

    /// Examines all slices, which stay in their files. Returns them with the total length of the files, and whether
    /// padding is replaced.
    pub fn layered(
        &self,
        voxel_size: Vec3,
        description: Vec<u8>,
    ) -> Result<(ScanVolume, u64, bool), FormatError> {
        let number = self.layout.number;
        let mut found = Survey::default();
        let files: Vec<&[FramePlane]> = by_file(self.planes).collect();
        for (i, some) in files.chunks(FILES_AT_ONCE).enumerate() {
            go_on(self.reading.progress)?;
            self.reading.progress.advance((i * FILES_AT_ONCE) as f32 / files.len() as f32);
            let of = some.par_iter().map(|planes| self.survey(planes));
            found = of.try_reduce(Survey::default, |a, b| Ok(a.and(b))).map(|of| found.and(of))?;
        }
        let filling =
            self.padding.zip(found.least).filter(|_| found.has_padding && !found.is_mixed);
        let numbers = StoredNumbers {
            number: if found.is_mixed { Number::F32 } else { number },
            is_big: false,
            scale: found.scale.filter(|_| !found.is_mixed).unwrap_or([1.0, 0.0]),
        };
        let decoder = SliceFiles {
            slices: self.planes.iter().map(|p| (self.files[p.file].clone(), p.clone())).collect(),
            layout: self.layout,
            is_scaled: found.is_mixed,
            filling,
            budget_bytes: budget_bytes(self.reading.limits),
        };
        let (place, progress) = ((self.dims, voxel_size), self.reading.progress);
        let volume =
            LayeredVolume::decoded(Arc::new(decoder), numbers, place, description, progress)?;
        Ok((volume.into(), found.file_bytes, filling.is_some()))
    }

    /// Examines frames of a file.
    fn survey(&self, planes: &[FramePlane]) -> Result<Survey, FormatError> {
        let budget_bytes = budget_bytes(self.reading.limits);
        let file = store::read(&self.files[planes[0].file], budget_bytes, |_| Ok(()), &())?;
        let mut found = Survey { file_bytes: file.len() as u64, ..Survey::default() };
        decode(&file, planes, &self.layout, budget_bytes, &mut |frame, scale| {
            let (has_padding, least) = match self.padding {
                Some(padding) => padding.find(&frame, self.layout.number),
                None => (false, None),
            };
            let of = Survey { scale: Some(scale), has_padding, least, ..Survey::default() };
            found = found.and(of);
            Ok(())
        })?;
        Ok(found)
    }
}

/// Returns the planes of each file; layers that repeat a slice are consecutive.
fn by_file(planes: &[FramePlane]) -> impl Iterator<Item = &[FramePlane]> {
    planes.chunk_by(|a, b| a.file == b.file)
}

/// Decodes frames of a file. Calls `take` with the numbers of each, and their slope and intercept.
fn decode(
    file: &[u8],
    planes: &[FramePlane],
    like: &PixelLayout,
    budget_bytes: u64,
    take: &mut dyn FnMut(Vec<u8>, [f64; 2]) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let (syntax, bytes) = data_set::open(file, ReadExtent::Whole, budget_bytes)?;
    let data = DataSet::parse(&bytes, syntax, ReadExtent::Whole)?;
    let layout = PixelLayout::of(&data)?;
    if !layout.fits(like) {
        return Err(FormatError::Scan(
            "the files of the series differ in size or type; keep each series in its own folder"
                .to_string(),
        ));
    }
    let frames = frames(&data)?;
    for plane in planes {
        let frame = layout.frame(&data, syntax, frames, plane.frame)?;
        let of = FrameData { data: &data, frame: plane.frame };
        let value = |tag| of.decimals::<1>(tags::VALUES_GROUP, tag).map(|[value]| value);
        let slope = value(tags::SLOPE).filter(|slope| *slope != 0.0).unwrap_or(1.0);
        take(frame, [slope, value(tags::INTERCEPT).unwrap_or(0.0)])?;
    }
    Ok(())
}

/// Frames one after the other: stored numbers while all have the same scale, else scaled values.
#[derive(Default)]
struct FrameStack {
    data: Vec<u8>,
    count: u32,
    scale: Option<[f64; 2]>,
    is_scaled: bool,
}

impl FrameStack {
    fn add(&mut self, frame: Vec<u8>, number: Number, scale: [f64; 2]) {
        let own = *self.scale.get_or_insert(scale);
        if own != scale && !self.is_scaled {
            self.data = number.to_floats(&self.data, false, own);
            self.is_scaled = true;
        }
        if self.is_scaled {
            self.data.append(&mut number.to_floats(&frame, false, scale));
        } else {
            self.data.extend_from_slice(&frame);
        }
        self.count += 1;
    }

    fn into_samples(self, number: Number) -> (Samples, Vec<u8>) {
        match self.is_scaled {
            true => (Samples::F32Le, self.data),
            false => number.into_samples(self.data, false, self.scale.unwrap_or([1.0, 0.0])),
        }
    }
}

/// The properties of frames that concern all of a volume.
#[derive(Clone, Copy, Default)]
struct Survey {
    file_bytes: u64,
    /// The scale of the first, and whether others differ.
    scale: Option<[f64; 2]>,
    is_mixed: bool,
    has_padding: bool,
    /// The least number that is no padding.
    least: Option<i64>,
}

impl Survey {
    fn and(self, other: Survey) -> Survey {
        let differ = self.scale.zip(other.scale).is_some_and(|(a, b)| a != b);
        Survey {
            file_bytes: self.file_bytes + other.file_bytes,
            scale: self.scale.or(other.scale),
            is_mixed: self.is_mixed || other.is_mixed || differ,
            has_padding: self.has_padding || other.has_padding,
            least: self.least.into_iter().chain(other.least).min(),
        }
    }
}

/// SeriesSlices that stay in their files.
#[derive(Debug)]
struct SliceFiles {
    /// The file and the frame of each layer.
    slices: Vec<(PathBuf, FramePlane)>,
    layout: PixelLayout,
    /// Whether slices differ in scale, so that each is scaled as it is read.
    is_scaled: bool,
    /// Padding, and the number that replaces it.
    filling: Option<(Padding, i64)>,
    budget_bytes: u64,
}

impl LayerDecoder for SliceFiles {
    fn layer(&self, z: u32) -> Result<Vec<u8>, FormatError> {
        let (path, plane) = &self.slices[z as usize];
        let (number, budget_bytes) = (self.layout.number, self.budget_bytes);
        let file = store::read(path, budget_bytes, |_| Ok(()), &())?;
        let mut layer = Vec::new();
        decode(
            &file,
            std::slice::from_ref(plane),
            &self.layout,
            budget_bytes,
            &mut |frame, scale| {
                layer = frame;
                if self.is_scaled {
                    layer = number.to_floats(&layer, false, scale);
                } else if let Some((padding, by)) = self.filling {
                    padding.replace(&mut layer, number, by);
                }
                Ok(())
            },
        )?;
        Ok(layer)
    }
}

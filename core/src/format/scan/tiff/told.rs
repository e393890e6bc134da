//! Reads the metadata of a TIFF file about its pages: the note of ImageJ, or the description of an OME-TIFF
//! (docs.openmicroscopy.org/ome-model).
//!
//! Takes the first page; gives the voxel size and the pages that are the layers of the channel and the time to read.

use std::collections::HashMap;
use std::io::{Read, Seek};

use glam::Vec3;
use roxmltree::{Document, Node};
use tiff::decoder::Decoder;
use tiff::decoder::ifd::Value;
use tiff::tags::Tag;

use super::super::reading::{OTHER_CHANNEL, OTHER_TIME, Reading};
use super::super::unit::mm_per_unit;
use crate::format::options::ImportOptions;
use crate::format::{FormatError, Volumes};

/// Greatest number of pages that are counted.
const MOST_PAGES: usize = 1 << 20;

/// The numbers of channels, layers and times.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct PlaneCounts {
    channels: usize,
    layers: usize,
    times: usize,
}

impl PlaneCounts {
    /// Returns the number of pages, unless there are too many.
    fn pages(self) -> Option<usize> {
        let pages = self.channels.checked_mul(self.layers)?.checked_mul(self.times)?;
        (pages <= MOST_PAGES).then_some(pages)
    }
}

/// A channel, a layer and a time.
type PlaneIndex = (usize, usize, usize);

/// The order of pages in the file.
#[derive(Debug)]
enum Order {
    /// Channels vary fastest, then layers, then times.
    Imagej,
    /// The pages that are in the file itself.
    Ome(HashMap<PlaneIndex, usize>),
}

#[derive(Debug)]
pub struct Told {
    pub is_of_imagej: bool,
    /// Number of pages, including those without directories.
    pub images: usize,
    /// In millimetres; 1 where nothing is known.
    pub voxel_size: Vec3,
    counts: Option<PlaneCounts>,
    order: Order,
    notes: Vec<String>,
}

impl Told {
    /// Reads the metadata of the current page.
    pub fn of<R: Read + Seek>(pages: &mut Decoder<R>) -> Told {
        let text = pages.get_tag_ascii_string(Tag::ImageDescription).unwrap_or_default();
        let mut told = Told {
            is_of_imagej: text.starts_with("ImageJ="),
            images: 1,
            voxel_size: Vec3::ONE,
            counts: None,
            order: Order::Imagej,
            notes: Vec::new(),
        };
        if told.is_of_imagej {
            told.imagej(&text, pages);
        } else if text.contains("<OME") || text.contains(":OME") {
            told.ome(&text);
        }
        told
    }

    /// Selects the pages of the channel and the time to read, the lowest layer first, with notes.
    pub(crate) fn one_volume(
        &self,
        pages: Vec<usize>,
        reading: &Reading,
        notes: &mut Vec<String>,
    ) -> Result<(Vec<usize>, Volumes), FormatError> {
        notes.extend(self.notes.iter().cloned());
        let told = self.counts.and_then(|counts| Some((counts, counts.pages()?)));
        let Some((PlaneCounts { channels, layers, times }, all)) = told.filter(|(_, all)| *all > 1)
        else {
            return Ok((pages, reading.volumes(1)?));
        };
        let ImportOptions { channel, time, .. } = *reading.options;
        let is_of_times = layers == 1 && times > 1 && time.is_none();
        let counts = [channels, if is_of_times { 1 } else { times }].map(|count| count as u64);
        let volumes = Volumes::or(reading.options, self.first_there(is_of_times), counts)?;
        let (c, t) = (volumes.channel.index() as usize, volumes.time.index() as usize);
        let own: Vec<usize> = match is_of_times {
            true => (0..times).filter_map(|t| self.page((c, 0, t))).collect(),
            false => (0..layers).filter_map(|z| self.page((c, z, t))).collect(),
        };
        if own.is_empty() || !own.iter().all(|page| pages.contains(page)) {
            let (found, number) = (pages.len(), volumes.channel.number);
            if channel.is_some() || time.is_some() {
                return Err(FormatError::Scan(format!(
                    "channel {number} at time {} is not in this file, which speaks of {all} pages, but has {found}; choose \
                     another, or open the file of the set that has it",
                    volumes.time.number
                )));
            }
            notes.push(format!(
                "the file speaks of {all} pages, but has {found}; those are its layers in their order"
            ));
            return Ok((pages, reading.volumes(1)?));
        }
        if is_of_times {
            notes.push(format!(
                "it has no layers; its {times} times were taken for them; the option `time` takes one of them"
            ));
        }
        for (what, taken) in volumes.several() {
            let (asked, other) = match what {
                "channel" => (channel, OTHER_CHANNEL),
                _ => (time, OTHER_TIME),
            };
            if asked.is_none() {
                let which = if taken.number == 1 { "the first" } else { "one of them" };
                notes.push(format!("its {what}s: {}; {which} was taken; {other}", taken.count));
            }
        }
        let missing = if is_of_times { times } else { layers } - own.len();
        if missing > 0 {
            notes.push(format!("layers in other files, which were left out: {missing}"));
        }
        Ok((own, volumes))
    }

    fn page(&self, place: PlaneIndex) -> Option<usize> {
        let (c, z, t) = place;
        match (&self.order, self.counts?) {
            (Order::Imagej, counts) => Some(c + counts.channels * (z + counts.layers * t)),
            (Order::Ome(pages), _) => pages.get(&place).copied(),
        }
    }

    /// Returns the numbers of the first channel and time that have a page in the file itself.
    fn first_there(&self, is_of_times: bool) -> [u64; 2] {
        let Order::Ome(pages) = &self.order else { return [1, 1] };
        let first =
            pages.keys().map(|(c, _, t)| if is_of_times { (0, *c) } else { (*t, *c) }).min();
        let (t, c) = first.unwrap_or_default();
        [c as u64 + 1, t as u64 + 1]
    }

    fn imagej<R: Read + Seek>(&mut self, text: &str, pages: &mut Decoder<R>) {
        let of = |key: &str| text.lines().find_map(|line| line.strip_prefix(key)).map(str::trim);
        let count = |key: &str| {
            let count = of(key).and_then(|text| text.parse().ok());
            count.filter(|count: &usize| (1..=MOST_PAGES).contains(count))
        };
        self.images = count("images=").unwrap_or(1);
        let (channels, times) = (count("channels=").unwrap_or(1), count("frames=").unwrap_or(1));
        let per_layer = channels.saturating_mul(times);
        let layers = count("slices=").unwrap_or((self.images / per_layer).max(1));
        let counts = PlaneCounts { channels, layers, times };
        self.counts = counts.pages().map(|_| counts);

        let unit = of("unit=").unwrap_or("pixel").to_lowercase();
        let Some(unit_mm) = mm_per_unit(&unit) else { return };
        let mut per_unit = |tag| match pages.get_tag(tag) {
            Ok(Value::Rational(count, units)) => Some(f64::from(units) / f64::from(count)),
            _ => None,
        };
        let (x, y) = (per_unit(Tag::XResolution), per_unit(Tag::YResolution));
        let z = of("spacing=").and_then(|text| text.parse().ok()).or(x);
        self.voxel_size = Vec3::from([x, y, z].map(|edge| length(edge, unit_mm).unwrap_or(1.0)));
    }

    fn ome(&mut self, text: &str) {
        let text = text.trim_end_matches('\0');
        let Ok(xml) = Document::parse(text) else {
            self.notes.push("its OME description cannot be read and was left out".to_string());
            return;
        };
        let named = |name: &'static str| {
            xml.descendants().filter(move |node| node.tag_name().name() == name)
        };
        let images = named("Image").count();
        let Some(pixels) = named("Pixels").next() else { return };
        if images > 1 {
            self.notes.push(format!("its images: {images}; the first was taken"));
        }
        let edges = ["X", "Y", "Z"].map(|axis| {
            let edge = pixels.attribute(format!("PhysicalSize{axis}").as_str())?.parse().ok();
            let unit = pixels.attribute(format!("PhysicalSize{axis}Unit").as_str());
            length(edge, mm_per_unit(&unit.unwrap_or("um").to_lowercase())?)
        });
        let known = edges.into_iter().flatten().next().unwrap_or(1.0);
        // An unspecified layer thickness is no reason to discard the other lengths.
        self.voxel_size = Vec3::from(edges.map(|edge| edge.unwrap_or(known)));
        let size = |axis: &str| {
            let size = pixels.attribute(format!("Size{axis}").as_str())?.parse().ok();
            size.filter(|size: &usize| (1..=MOST_PAGES).contains(size))
        };
        let (Some(channels), Some(layers), Some(times)) = (size("C"), size("Z"), size("T")) else {
            return;
        };
        let channel = pixels.children().find(|node| node.tag_name().name() == "Channel");
        let samples = channel.and_then(|node| node.attribute("SamplesPerPixel")?.parse().ok());
        let channels = channels / samples.filter(|n| (1..=channels).contains(n)).unwrap_or(1);
        let counts = PlaneCounts { channels, layers, times };
        let Some(whole) = counts.pages() else { return };
        self.images = whole;
        self.order = Order::Ome(ome_pages(pixels, counts, whole));
        self.counts = Some(counts);
    }
}

/// Returns the page of each channel, layer and time.
fn ome_pages(pixels: Node, counts: PlaneCounts, whole: usize) -> HashMap<PlaneIndex, usize> {
    let order = pixels.attribute("DimensionOrder").unwrap_or("XYCZT");
    // The remaining pages, from `from` planes after the first of all.
    let place = |mut from: usize| {
        let mut at = (0, 0, 0);
        for axis in order.chars() {
            let (own, size) = match axis {
                'C' => (&mut at.0, counts.channels),
                'Z' => (&mut at.1, counts.layers),
                'T' => (&mut at.2, counts.times),
                _ => continue,
            };
            *own = from % size;
            from /= size;
        }
        at
    };
    let number_of = |(c, z, t): PlaneIndex| {
        let (mut number, mut step) = (0, 1);
        for axis in order.chars() {
            let (own, size) = match axis {
                'C' => (c, counts.channels),
                'Z' => (z, counts.layers),
                'T' => (t, counts.times),
                _ => continue,
            };
            number += own.min(size - 1) * step;
            step *= size;
        }
        number
    };
    let mut pages = HashMap::new();
    let blocks = pixels.children().filter(|node| node.tag_name().name() == "TiffData");
    // The pages of other files of a set are not in this file.
    let own = own_file(pixels);
    let mut has_blocks = false;
    for block in blocks {
        has_blocks = true;
        let file = block.children().find(|node| node.tag_name().name() == "UUID");
        if file.and_then(|node| node.text()).is_some_and(|file| Some(file) != own) {
            continue;
        }
        let number = |name: &str| block.attribute(name).and_then(|text| text.parse().ok());
        let page = number("IFD").unwrap_or(0);
        let usual = if block.has_attribute("IFD") { 1 } else { whole };
        let count: usize = number("PlaneCount").unwrap_or(usual);
        let first = |name: &str| number(name).unwrap_or(0);
        let first = number_of((first("FirstC"), first("FirstZ"), first("FirstT")));
        for i in 0..count.min(whole - first) {
            pages.entry(place(first + i)).or_insert(page + i);
        }
    }
    if !has_blocks {
        pages.extend((0..whole).map(|i| (place(i), i)));
    }
    pages
}

/// Returns the identifier of the file itself in its description.
fn own_file<'a>(pixels: Node<'a, 'a>) -> Option<&'a str> {
    pixels.document().root_element().attribute("UUID")
}

/// Returns a length in millimetres, if it is valid.
fn length(edge: Option<f64>, unit_mm: f64) -> Option<f32> {
    edge.map(|edge| (edge * unit_mm) as f32).filter(|edge| edge.is_finite() && *edge > 0.0)
}

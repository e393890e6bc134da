//! Reads the words of a TIFF file about its pages beside their pixels: the note of ImageJ, or the description of an OME-TIFF
//! (docs.openmicroscopy.org/ome-model).
//!
//! Takes the first page; gives the size of a voxel and which pages are the layers of one channel at one time.

use std::collections::HashMap;

use glam::Vec3;
use roxmltree::{Document, Node};
use tiff::decoder::ifd::Value;
use tiff::tags::Tag;

use super::super::unit::mm_per_unit;
use super::Pages;

/// Pages of a file that are counted.
const MOST_PAGES: usize = 1 << 20;

/// The numbers of channels, layers and times.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Counts {
    channels: usize,
    layers: usize,
    times: usize,
}

#[derive(Debug)]
pub struct Told {
    pub is_of_imagej: bool,
    /// Pages, also those without directories.
    pub images: usize,
    /// In millimetres; 1 where nothing is known.
    pub voxel_size: Vec3,
    counts: Option<Counts>,
    /// The pages of the first channel and time, the lowest layer first.
    first_volume: Vec<usize>,
    notes: Vec<String>,
}

impl Told {
    /// Of the page that is open.
    pub fn of(pages: &mut Pages) -> Told {
        let text = pages.get_tag_ascii_string(Tag::ImageDescription).unwrap_or_default();
        let mut told = Told {
            is_of_imagej: text.starts_with("ImageJ="),
            images: 1,
            voxel_size: Vec3::ONE,
            counts: None,
            first_volume: Vec::new(),
            notes: Vec::new(),
        };
        if told.is_of_imagej {
            told.imagej(&text, pages);
        } else if text.contains("<OME") || text.contains(":OME") {
            told.ome(&text);
        }
        told
    }

    /// Of the pages of a file those of one volume, with notes.
    pub fn pages_of_one_volume(&self, pages: Vec<usize>, notes: &mut Vec<String>) -> Vec<usize> {
        notes.extend(self.notes.iter().cloned());
        let Some(Counts { channels, layers, times }) = self.counts else { return pages };
        if channels * layers * times < 2 {
            return pages;
        }
        if !self.first_volume.iter().all(|page| pages.contains(page)) {
            notes.push(format!(
                "the file speaks of {} pages, but has {}; those are its layers in their order",
                channels * layers * times,
                pages.len()
            ));
            return pages;
        }
        if channels > 1 {
            notes.push(format!("its channels: {channels}; the first was taken"));
        }
        if times > 1 {
            notes.push(format!("its times: {times}; the first was taken"));
        }
        self.first_volume.clone()
    }

    fn imagej(&mut self, text: &str, pages: &mut Pages) {
        let of = |key: &str| text.lines().find_map(|line| line.strip_prefix(key)).map(str::trim);
        let count = |key: &str| {
            let count = of(key).and_then(|text| text.parse().ok());
            count.filter(|count: &usize| (1..=MOST_PAGES).contains(count))
        };
        self.images = count("images=").unwrap_or(1);
        let (channels, times) = (count("channels=").unwrap_or(1), count("frames=").unwrap_or(1));
        let per_layer = channels.saturating_mul(times);
        let mut counts = Counts {
            channels,
            layers: count("slices=").unwrap_or((self.images / per_layer).max(1)),
            times,
        };
        if counts.layers == 1 && times > 1 {
            counts = Counts { layers: times, times: 1, ..counts };
            self.notes.push(format!("it has no layers; its {times} times were taken for them"));
        }
        self.counts = counts
            .layers
            .checked_mul(per_layer)
            .is_some_and(|pages| pages <= MOST_PAGES)
            .then_some(counts);
        // Channels follow one another, then layers, then times.
        self.first_volume = (0..counts.layers.min(MOST_PAGES)).map(|z| z * channels).collect();

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
        // A layer's thickness that is not named is no reason to leave the others out.
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
        let mut counts = Counts { channels, layers, times };
        let whole = channels.checked_mul(layers).and_then(|n| n.checked_mul(times));
        let Some(whole) = whole.filter(|whole| *whole <= MOST_PAGES) else { return };
        self.images = whole;
        let page_of = ome_pages(pixels, counts, whole);
        let has_no_layers = layers == 1 && times > 1;
        if has_no_layers {
            counts = Counts { layers: times, times: 1, ..counts };
            self.notes.push(format!("it has no layers; its {times} times were taken for them"));
        }
        let place = |i: usize| if has_no_layers { (0, 0, i) } else { (0, i, 0) };
        let found = (0..counts.layers).filter_map(|i| page_of.get(&place(i)).copied());
        self.first_volume = found.collect();
        if self.first_volume.len() < counts.layers {
            let missing = counts.layers - self.first_volume.len();
            self.notes.push(format!("layers in other files, which were left out: {missing}"));
        }
        self.counts = Some(counts);
    }
}

/// The page of each channel, layer and time.
fn ome_pages(pixels: Node, counts: Counts, whole: usize) -> HashMap<(usize, usize, usize), usize> {
    let order = pixels.attribute("DimensionOrder").unwrap_or("XYCZT");
    // The rest, from `from` planes behind the first of all.
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
    let number_of = |(c, z, t): (usize, usize, usize)| {
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
    // The pages of other files of a set are not this file's.
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

/// The identifier of the file itself, as its description has it.
fn own_file<'a>(pixels: Node<'a, 'a>) -> Option<&'a str> {
    pixels.document().root_element().attribute("UUID")
}

/// A length in millimetres, if it is one.
fn length(edge: Option<f64>, unit_mm: f64) -> Option<f32> {
    edge.map(|edge| (edge * unit_mm) as f32).filter(|edge| edge.is_finite() && *edge > 0.0)
}

//! Reads segmentations of 3D Slicer (`.seg.nrrd`): the label, layer, name and colour of each segment, from the pairs of
//! keys and values in the header of an NRRD file.
//!
//! Takes the pairs and the layers of labels; gives voxels in the segments' colours. Knows no file.

use std::collections::HashMap;

use crate::format::error::excerpt;
use crate::format::labels;
use crate::sculpture::Rgb;

/// Greatest number of segments.
const MOST_SEGMENTS: usize = 1 << 12;
/// Greatest number of names that a note lists.
const SHOWN: usize = 12;

struct Segment {
    layer: usize,
    label: f64,
    colour: Option<Rgb>,
    name: String,
}

pub struct Segments(Vec<Segment>);

impl Segments {
    /// Returns `None` where the pairs describe no segments. `layers` is the number of label volumes.
    pub fn of(pairs: &HashMap<String, String>, layers: u64) -> Option<Segments> {
        let of = |i: usize, what: &str| pairs.get(&format!("Segment{i}_{what}"));
        let is_there = |i: &usize| {
            ["ID", "Name", "LabelValue", "Color"].into_iter().any(|what| of(*i, what).is_some())
        };
        let count = (0..MOST_SEGMENTS).take_while(is_there).count();
        // Older versions of Slicer give each segment its own layer, where its label is 1.
        let is_old = layers > 1 && layers == count as u64;
        let segments = (0..count).map(|i| {
            let number = |what: &str| of(i, what).and_then(|text| text.trim().parse::<f64>().ok());
            let levels = of(i, "Color").map(|text| {
                let levels = text.split_whitespace().map_while(|word| word.parse::<f64>().ok());
                levels
                    .map(|level| (level.clamp(0.0, 1.0) * 255.0).round() as u8)
                    .collect::<Vec<_>>()
            });
            let layer = number("Layer").unwrap_or(if is_old { i as f64 } else { 0.0 });
            let alone = if is_old { 1.0 } else { (i + 1) as f64 };
            Segment {
                layer: layer.max(0.0) as usize,
                label: number("LabelValue").unwrap_or(alone),
                colour: levels.and_then(|levels| Some(Rgb(levels.try_into().ok()?))),
                name: of(i, "Name")
                    .or(of(i, "ID"))
                    .map_or(String::new(), |name| excerpt(name.as_bytes())),
            }
        });
        (count > 0).then(|| Segments(segments.collect()))
    }

    /// Returns red, green, blue and opacity of each voxel. A later layer covers an earlier one.
    pub fn colours(&self, layers: &[Vec<f32>]) -> Vec<u8> {
        let plain = labels::colours();
        let tables: Vec<HashMap<u32, Rgb>> = (0..layers.len())
            .map(|layer| {
                let own = self.0.iter().filter(|segment| segment.layer == layer);
                let own = own.filter_map(|own| Some(((own.label as f32).to_bits(), own.colour?)));
                own.collect()
            })
            .collect();
        let count = layers.first().map_or(0, Vec::len);
        let mut out = vec![0; 4 * count];
        for (layer, table) in layers.iter().zip(&tables) {
            for (voxel, label) in out.as_chunks_mut::<4>().0.iter_mut().zip(layer) {
                if *label == 0.0 || label.is_nan() {
                    continue;
                }
                let own = table.get(&label.to_bits()).copied();
                let Rgb([r, g, b]) = own.unwrap_or_else(|| labels::colour(&plain, *label));
                *voxel = [r, g, b, 255];
            }
        }
        out
    }

    /// Returns the note for the user.
    pub fn note(&self) -> String {
        let names: Vec<&str> = self.0.iter().take(SHOWN).map(|own| own.name.as_str()).collect();
        let more = if self.0.len() > SHOWN { ", ..." } else { "" };
        let count = self.0.len();
        format!("a segmentation in its own colours, segments: {count} ({}{more})", names.join(", "))
    }
}

//! Reads the notes of slicers in a `.3mf` about parts that are not printed: supports, modifiers, negative volumes.
//!
//! Takes the texts of their files in the archive (`Slic3r_PE_model.config` of PrusaSlicer and SuperSlicer,
//! `model_settings.config` of Bambu Studio and OrcaSlicer); gives the part of each listed triangle or component of an
//! object. A file that cannot be read is ignored.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use roxmltree::{Document, Node};

/// Paths of these files in the archive.
pub const PLACES: [&str; 2] = ["Metadata/Slic3r_PE_model.config", "Metadata/model_settings.config"];

/// Parts that are not printed, by the number of their object.
#[derive(Default)]
pub struct UnprintedParts {
    /// PrusaSlicer: triangles of the object's mesh.
    ranges: HashMap<u32, Vec<(RangeInclusive<usize>, &'static str)>>,
    /// Bambu Studio: components of the object, by the number of the object that they place.
    components: HashMap<(u32, u32), &'static str>,
}

impl UnprintedParts {
    /// Adds the parts that a file lists.
    pub fn read(&mut self, text: &str) {
        let Ok(xml) = Document::parse(text) else { return };
        let objects = xml.descendants().filter(|node| node.has_tag_name("object"));
        for (object, id) in objects.filter_map(|node| Some((node, number(node, "id")?))) {
            for part in object.children() {
                let setting = |key: &str| {
                    let settings = part.children().filter(|node| node.has_tag_name("metadata"));
                    settings
                        .filter(|node| node.attribute("key") == Some(key))
                        .find_map(|node| node.attribute("value"))
                };
                // Older versions of the slicer know only modifiers.
                let older = || (setting("modifier") == Some("1")).then_some("ParameterModifier");
                let kind = part.attribute("subtype").or_else(|| setting("volume_type"));
                let Some(kind) = kind.or_else(older).and_then(named) else { continue };
                let range = number(part, "firstid").zip(number(part, "lastid"));
                if let Some((first, last)) = range {
                    let range = first as usize..=last as usize;
                    self.ranges.entry(id).or_default().push((range, kind));
                } else if let Some(component) = number(part, "id") {
                    self.components.insert((id, component), kind);
                }
            }
        }
    }

    /// Returns the unprinted part to which a triangle of an object's mesh belongs.
    pub(crate) fn of_triangle(&self, object: u32, triangle: usize) -> Option<&'static str> {
        let ranges = self.ranges.get(&object)?;
        ranges.iter().find(|(range, _)| range.contains(&triangle)).map(|(_, kind)| *kind)
    }

    /// Returns the kind of a component that is not printed.
    pub(crate) fn of_component(&self, object: u32, component: u32) -> Option<&'static str> {
        self.components.get(&(object, component)).copied()
    }
}

fn number(node: Node, name: &str) -> Option<u32> {
    node.attribute(name)?.trim().parse().ok()
}

/// Returns the display name of a kind of part that is not printed as it is.
fn named(kind: &str) -> Option<&'static str> {
    Some(match kind {
        "SupportEnforcer" | "support_enforcer" => "support enforcer",
        "SupportBlocker" | "support_blocker" => "support blocker",
        "ParameterModifier" | "modifier_part" => "modifier",
        "NegativeVolume" | "negative_part" => "negative volume, which takes away from others",
        _ => return None,
    })
}

//! Remembers reference pictures: their files and positions, as TOML values.

use std::path::PathBuf;

use glam::Vec2;
use serde::{Deserialize, Serialize};

use crate::render::MAX_REFERENCES;
use crate::ui::references::{HEIGHT_RANGE_VX, Layer, OFFSET_RANGE_VX, Reference, sides};

#[derive(Serialize, Deserialize)]
struct KeptReference {
    path: String,
    side: String,
    layer: String,
    shown: bool,
    locked: bool,
    opacity: f64,
    height_vx: f64,
    offset_vx: [f64; 2],
}

/// Returns the values of `references`. Skips a path that is not valid Unicode.
pub fn to_values(references: &[Reference]) -> Vec<toml::Value> {
    let kept = references.iter().filter_map(|reference| {
        let neat = |value: f32| value.to_string().parse().unwrap_or(f64::from(value));
        Some(KeptReference {
            path: reference.path.to_str()?.to_string(),
            side: reference.side.name().to_string(),
            layer: reference.layer.name().to_string(),
            shown: reference.shown,
            locked: reference.locked,
            opacity: neat(reference.opacity),
            height_vx: neat(reference.height_vx),
            offset_vx: reference.offset_vx.to_array().map(neat),
        })
    });
    kept.filter_map(|kept| toml::Value::try_from(kept).ok()).collect()
}

/// Returns the references of such values; their files are not read yet. Skips invalid values.
pub fn from_values(values: Vec<toml::Value>) -> Vec<Reference> {
    let known = values.into_iter().filter_map(|value| {
        let kept: KeptReference = value.try_into().ok()?;
        let offset = kept.offset_vx.map(|value| value as f32);
        let height = kept.height_vx as f32;
        let opacity = kept.opacity as f32;
        let good = HEIGHT_RANGE_VX.contains(&height)
            && (0.0..=1.0).contains(&opacity)
            && offset.iter().all(|value| OFFSET_RANGE_VX.contains(value));
        let side = sides().find(|side| side.name() == kept.side)?;
        let layer = Layer::ALL.into_iter().find(|layer| layer.name() == kept.layer)?;
        good.then(|| Reference {
            shown: kept.shown,
            locked: kept.locked,
            layer,
            opacity,
            offset_vx: Vec2::from(offset),
            ..Reference::new(PathBuf::from(kept.path), None, side, height)
        })
    });
    known.take(MAX_REFERENCES).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Side;

    #[test]
    fn a_remembered_picture_comes_back_and_damaged_values_are_left_out() {
        let reference = Reference {
            layer: Layer::Before,
            locked: true,
            shown: false,
            opacity: 0.35,
            offset_vx: Vec2::new(-3.5, 12.0),
            ..Reference::new("/a/\"plan\".png".into(), None, Side::Left, 77.7)
        };
        let values = to_values(std::slice::from_ref(&reference));
        assert_eq!(from_values(values.clone()), [reference]);
        for (key, bad) in [
            ("opacity", toml::Value::Float(f64::NAN)),
            ("height_vx", toml::Value::Float(-1.0)),
            ("side", toml::Value::String("3/4".into())),
            ("layer", toml::Value::Integer(1)),
        ] {
            let mut damaged = values[0].clone();
            damaged[key] = bad;
            assert!(from_values(vec![damaged]).is_empty(), "{key}");
        }
        assert_eq!(from_values(vec![values[0].clone(); 100]).len(), MAX_REFERENCES);
    }
}

//! Remembers the options of brushes, using their descriptions. Also reads tables of earlier versions.

use crate::editor::brushes::Brushes;
use crate::editor::sizes::SizeUnit;
use crate::tools::brush::BrushId;
use crate::tools::brush::keys::{
    BITE, FALLOFF, ONCE_PER_STROKE, OUTLINE, RADIUS, REACH, STEADY, STRENGTH, THRESHOLD,
};
use crate::tools::brush::param::{Domain, OptionValue, Param};
use crate::ui::memory::values::neat;

/// The keys of brushes under an outline until November 2026, with today's.
const OLD_SPRAY_KEYS: [(&str, &str); 7] = [
    ("radius_px", RADIUS.param.key),
    ("square", OUTLINE.param.key),
    ("reach_vx", REACH.param.key),
    ("bites_cubes", BITE.param.key),
    ("threshold", THRESHOLD.param.key),
    ("cover", STRENGTH.param.key),
    ("once_a_stroke", ONCE_PER_STROKE.param.key),
];
/// Likewise for brushes that deform.
const OLD_DEFORM_KEYS: [(&str, &str); 4] = [
    ("radius", RADIUS.param.key),
    ("strength", STRENGTH.param.key),
    ("falloff", FALLOFF.param.key),
    ("steady_px", STEADY.param.key),
];

/// Returns a table of options for each brush, under its name.
pub fn kept(brushes: &Brushes) -> toml::Table {
    let table = |brush: BrushId| {
        let options = brushes.of(brush).iter();
        toml::Value::Table(options.map(|(p, value)| (p.key.to_string(), text(p, value))).collect())
    };
    BrushId::ALL.iter().map(|brush| (brush.spec().name.to_string(), table(*brush))).collect()
}

/// Restores options; missing or invalid ones get their defaults. `unit`: of the radii.
pub fn recall(kept: &toml::Table, unit: SizeUnit, brushes: &mut Brushes) {
    recall_by(kept, unit, brushes, |param| Some(param.key));
}

/// Restores options of brushes under an outline as earlier versions wrote them. Without a unit, smoothing had no
/// strength.
pub fn recall_sprays(kept: &toml::Table, unit: Option<SizeUnit>, brushes: &mut Brushes) {
    let first = brushes.of(BrushId::Smooth).get(STRENGTH);
    recall_by(kept, unit.unwrap_or_default(), brushes, |param| old_key(param, &OLD_SPRAY_KEYS));
    if unit.is_none() {
        brushes.of_mut(BrushId::Smooth).set(STRENGTH, first);
    }
}

/// Restores options of brushes that deform as earlier versions wrote them. Without a unit, their radii were in another
/// one.
pub fn recall_deforms(kept: &toml::Table, unit: Option<SizeUnit>, brushes: &mut Brushes) {
    let is_read = |param: &Param| unit.is_some() || param.domain != Domain::Radius;
    recall_by(kept, unit.unwrap_or_default(), brushes, |param| {
        old_key(param, &OLD_DEFORM_KEYS).filter(|_| is_read(param))
    });
}

fn old_key(param: &Param, keys: &[(&'static str, &str)]) -> Option<&'static str> {
    keys.iter().find(|(_, now)| *now == param.key).map(|(old, _)| *old)
}

/// Restores options by their keys. `key`: the key of an option.
fn recall_by(
    kept: &toml::Table,
    unit: SizeUnit,
    brushes: &mut Brushes,
    key: impl Fn(&Param) -> Option<&'static str>,
) {
    for &brush in BrushId::ALL {
        let Some(toml::Value::Table(kept)) = kept.get(brush.spec().name) else { continue };
        let options = brushes.of_mut(brush);
        for param in brush.spec().options {
            let value = key(param).and_then(|key| value(param, kept.get(key)?));
            if let Some(value) = value.filter(|value| param.allows(*value, unit.radii())) {
                options.set_value(param.key, value);
            }
        }
    }
}

fn text(param: &Param, value: OptionValue) -> toml::Value {
    match (param.domain, value) {
        (_, OptionValue::Number(number)) => toml::Value::Float(neat(number)),
        (_, OptionValue::Whole(count)) => toml::Value::Integer(i64::from(count)),
        (_, OptionValue::On(on)) => toml::Value::Boolean(on),
        (Domain::Choice(choices), OptionValue::Choice(place)) => {
            let name = choices.get(usize::from(place)).map_or("", |choice| choice.name);
            toml::Value::String(name.to_string())
        }
        (_, OptionValue::Colour(colour)) => toml::Value::String(colour.to_string()),
        (_, OptionValue::Choice(_) | OptionValue::Absent) => toml::Value::String(String::new()),
    }
}

fn value(param: &Param, kept: &toml::Value) -> Option<OptionValue> {
    match (param.domain, kept) {
        (Domain::Radius | Domain::Number(_), toml::Value::Float(number)) => {
            Some(OptionValue::Number(*number as f32))
        }
        (Domain::Radius | Domain::Number(_), toml::Value::Integer(number)) => {
            Some(OptionValue::Number(*number as f32))
        }
        (Domain::Whole(_), toml::Value::Integer(count)) => {
            u32::try_from(*count).ok().map(OptionValue::Whole)
        }
        (Domain::Switch, toml::Value::Boolean(on)) => Some(OptionValue::On(*on)),
        (Domain::Colour, toml::Value::String(colour)) => {
            colour.parse().ok().map(OptionValue::Colour)
        }
        (Domain::Choice(choices), toml::Value::String(name)) => {
            let place = choices.iter().position(|choice| choice.name == name)?;
            Some(OptionValue::Choice(place as u8))
        }
        // The second of two choices used to be a switch.
        (Domain::Choice(_), toml::Value::Boolean(second)) => {
            Some(OptionValue::Choice(u8::from(*second)))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns every option of every brush with a value other than its default.
    fn changed() -> Brushes {
        let mut brushes = Brushes::default();
        for &brush in BrushId::ALL {
            for (param, value) in brushes.of(brush).clone().iter() {
                let value = match value {
                    OptionValue::Number(number) => OptionValue::Number(0.25 * number + 0.5),
                    OptionValue::Whole(count) => OptionValue::Whole(count + 1),
                    OptionValue::On(on) => OptionValue::On(!on),
                    OptionValue::Choice(place) => OptionValue::Choice(1 - place.min(1)),
                    OptionValue::Absent | OptionValue::Colour(_) => panic!("{param:?}"),
                };
                brushes.of_mut(brush).set_value(param.key, value);
            }
        }
        brushes
    }

    #[test]
    fn every_option_is_found_again() {
        let brushes = changed();
        let text = toml::to_string(&kept(&brushes)).unwrap();
        let mut again = Brushes::default();
        recall(&text.parse().unwrap(), SizeUnit::Screen, &mut again);
        assert_eq!(again, brushes);
    }

    #[test]
    fn nonsense_is_not_believed() {
        for text in [
            "",
            "clay = 3",
            "[clay]\nradius = 0.0\nreach = nan\noutline = \"oval\"\nonce_per_stroke = 1",
            "[clay]\nradius = inf\nreach = -1\noutline = 3",
            "[erosion]\nthreshold = 27\n[growth]\nthreshold = -1\n[dilation]\nthreshold = 9.0",
            "[grab]\nfalloff = \"steep\"\nstrength = 1.5\n[draw]\nsteady = -1\n[unknown]\nradius = 3",
        ] {
            let kept: toml::Table = text.parse().unwrap();
            let mut brushes = Brushes::default();
            recall(&kept, SizeUnit::Screen, &mut brushes);
            recall_sprays(&kept, Some(SizeUnit::Screen), &mut brushes);
            recall_deforms(&kept, Some(SizeUnit::Screen), &mut brushes);
            assert_eq!(brushes, Brushes::default(), "{text}");
        }
    }

    #[test]
    fn radii_and_strengths_of_the_first_versions_meant_something_else() {
        let kept = "[smooth]\ncover = 0.25\nradius_px = 33\n[grab]\nradius = 9.5\nstrength = 0.5";
        let kept: toml::Table = kept.parse().unwrap();
        let read = |unit| {
            let mut brushes = Brushes::default();
            recall_sprays(&kept, unit, &mut brushes);
            recall_deforms(&kept, unit, &mut brushes);
            let of = |brush| (brushes.radius(brush), brushes.of(brush).get(STRENGTH));
            (of(BrushId::Smooth), of(BrushId::Grab))
        };
        assert_eq!(read(None), ((33.0, 0.5), (60.0, 0.5)));
        assert_eq!(read(Some(SizeUnit::Screen)), ((33.0, 0.25), (9.5, 0.5)));
    }
}

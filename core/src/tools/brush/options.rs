//! The values of a brush: one for each parameter that its description lists, in interactive use or in a command.

use super::BrushId;
use super::param::{Key, OptionValue, Param, ParamValue};

/// Greatest number of parameters in a list.
const MOST: usize = 8;

/// A value for each parameter of a list, which the owner knows. Unused ones are absent.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct ParamValues([OptionValue; MOST]);

impl ParamValues {
    pub fn new(params: &[Param], value: impl Fn(&Param) -> OptionValue) -> ParamValues {
        let mut values = [OptionValue::Absent; MOST];
        values.iter_mut().zip(params).for_each(|(slot, param)| *slot = value(param));
        ParamValues(values)
    }

    pub fn get(&self, params: &[Param], key: &str) -> Option<OptionValue> {
        place(params, key).map(|place| self.0[place])
    }

    pub fn set(&mut self, params: &[Param], key: &str, value: OptionValue) {
        if let Some(place) = place(params, key) {
            self.0[place] = value;
        }
    }

    pub fn iter(
        self,
        params: &'static [Param],
    ) -> impl Iterator<Item = (&'static Param, OptionValue)> + use<> {
        params.iter().zip(self.0)
    }
}

fn place(params: &[Param], key: &str) -> Option<usize> {
    params.iter().position(|param| param.key == key)
}

/// The options with which a brush is used interactively.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct BrushOptions {
    brush: BrushId,
    values: ParamValues,
}

impl BrushOptions {
    /// Returns the default options of a brush.
    pub fn first(brush: BrushId) -> BrushOptions {
        BrushOptions { brush, values: ParamValues::new(brush.spec().options, |param| param.first) }
    }

    /// Returns these options for another brush, as far as it has them.
    pub fn of(&self, brush: BrushId) -> BrushOptions {
        let mut options = BrushOptions::first(brush);
        self.iter().for_each(|(param, value)| options.set_value(param.key, value));
        options
    }

    /// Returns the brush.
    pub fn brush(&self) -> BrushId {
        self.brush
    }

    /// Returns whether the brush has an option.
    pub fn has<T>(&self, key: Key<T>) -> bool {
        place(self.params(), key.param.key).is_some()
    }

    /// Returns the value of an option, or its usual value if the brush does not have it.
    pub fn get<T: ParamValue + Default>(&self, key: Key<T>) -> T {
        let value = self.values.get(self.params(), key.param.key).unwrap_or(key.param.first);
        T::from_value(value).unwrap_or_default()
    }

    /// Sets an option, if the brush has it.
    pub fn set<T: ParamValue>(&mut self, key: Key<T>, value: T) {
        self.set_value(key.param.key, value.to_value());
    }

    /// Returns the same options with another value of one of them.
    pub fn with<T: ParamValue>(mut self, key: Key<T>, value: T) -> BrushOptions {
        self.set(key, value);
        self
    }

    /// Sets an option given by its name.
    pub fn set_value(&mut self, key: &str, value: OptionValue) {
        self.values.set(self.params(), key, value);
    }

    /// Returns all options with their values, in the order in which panels show them.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Param, OptionValue)> + use<> {
        self.values.iter(self.params())
    }

    fn params(&self) -> &'static [Param] {
        self.brush.spec().options
    }
}
#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::super::footprint::{MAX_FOOTPRINT, Outline};
    use super::super::keys::{BITE, FALLOFF, OUTLINE, RADIUS, REACH, STEADY, STRENGTH};
    use super::super::param::Domain;
    use super::*;

    #[test]
    fn every_brush_begins_with_options_that_it_can_have() {
        for &brush in BrushId::ALL {
            let options = BrushOptions::first(brush);
            assert!(options.has(RADIUS), "{brush:?}");
            assert!(brush.spec().options.len() <= MOST, "{brush:?}");
            let keys: HashSet<&str> = options.iter().map(|(param, _)| param.key).collect();
            assert_eq!(keys.len(), brush.spec().options.len(), "{brush:?}");
            for (param, value) in options.iter() {
                assert!(param.allows(value, 1.0..=MAX_FOOTPRINT), "{brush:?}: {param:?}");
                assert!(!param.label.is_empty() && !param.help.is_empty(), "{param:?}");
                assert!(!param.help.contains('\n') && !param.help.contains("  "), "{param:?}");
                assert!((param.domain == Domain::Radius) == (param.key == RADIUS.param.key));
            }
        }
    }

    #[test]
    fn an_option_is_found_by_its_key_and_one_that_a_brush_lacks_is_as_usual() {
        let mut options = BrushOptions::first(BrushId::Devour);
        assert_eq!((options.get(REACH), options.get(BITE)), (3.0, Outline::Round));
        options.set(BITE, Outline::Square);
        options.set(REACH, 7.5);
        assert_eq!((options.get(REACH), options.get(BITE)), (7.5, Outline::Square));
        assert_eq!(options.get(OUTLINE), Outline::Round);
        let before = options;
        options.set(STEADY, 50.0);
        options.set_value("no such option", OptionValue::On(true));
        assert_eq!(options, before);
        assert!(!options.has(STEADY) && options.get(STEADY) == 0.0);
        assert_eq!((options.get(STRENGTH), options.get(FALLOFF).name()), (1.0, "smooth"));
    }
}

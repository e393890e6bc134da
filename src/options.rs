//! The contract of options: every room owns a type with its options, their defaults and a check, and reports an invalid
//! value as an [`InvalidOption`].
//!
//! Must not know the options, nor their file: `config` adds both.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, de};

/// An option with an invalid value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InvalidOption {
    /// The option's path within its options type, such as `size_m` or `lamps.intensity`.
    pub key: &'static str,
    pub value: String,
    /// The rule for the value, such as "must be 0 to 1".
    pub rule: &'static str,
}

/// Fails with `rule` unless `is_valid`.
pub fn require(
    is_valid: bool,
    key: &'static str,
    value: impl Display,
    rule: &'static str,
) -> Result<(), InvalidOption> {
    match is_valid {
        true => Ok(()),
        false => Err(InvalidOption { key, value: value.to_string(), rule }),
    }
}

/// Fails with `rule` unless `value` is in `range`. NaN is in no range.
pub fn require_in<T: PartialOrd + Display>(
    range: RangeInclusive<T>,
    key: &'static str,
    value: T,
    rule: &'static str,
) -> Result<(), InvalidOption> {
    require(range.contains(&value), key, value, rule)
}

/// Deserializes a value from its text form.
pub fn from_text<'de, D: Deserializer<'de>, T: FromStr<Err: Display>>(
    from: D,
) -> Result<T, D::Error> {
    String::deserialize(from)?.parse().map_err(de::Error::custom)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_outside_of_a_range_and_nan_are_refused() {
        assert_eq!(require_in(0.0..=1.0, "share", 1.0, "must be 0 to 1"), Ok(()));
        let error = require_in(0.0..=1.0, "share", 1.5, "must be 0 to 1").unwrap_err();
        let expected = InvalidOption { key: "share", value: "1.5".into(), rule: "must be 0 to 1" };
        assert_eq!(error, expected);
        assert!(require_in(0.0..=1.0, "share", f32::NAN, "must be 0 to 1").is_err());
    }
}

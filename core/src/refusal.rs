//! The two errors that all modules share: a value that breaks a rule, and work that needs more memory than is allowed.
//!
//! Takes names, rules and numbers; returns errors with a message for users. Knows no sculpture, no setting and no flag.

use std::borrow::Cow;
use std::fmt::{self, Display};

use thiserror::Error;

/// A value that breaks the rule of its field.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub struct InvalidValue {
    /// The owner of the field, such as `brush`; `None` where the field's name suffices.
    pub owner: Option<&'static str>,
    /// The field, such as `reach`.
    pub field: &'static str,
    /// Continues the message after the field's name: `must be from 0 to 64`.
    pub rule: Cow<'static, str>,
    /// The refused value as text; `None` if it is missing or too long to show.
    pub value: Option<String>,
}

impl InvalidValue {
    /// Returns an error for a value of `field` that breaks `rule`.
    pub fn new(
        field: &'static str,
        rule: impl Into<Cow<'static, str>>,
        value: impl Display,
    ) -> InvalidValue {
        let value = Some(value.to_string());
        InvalidValue { owner: None, field, rule: rule.into(), value }
    }

    /// Returns an error for a field that breaks `rule` and has no value to show.
    pub fn without_value(field: &'static str, rule: impl Into<Cow<'static, str>>) -> InvalidValue {
        InvalidValue { owner: None, field, rule: rule.into(), value: None }
    }

    /// Returns the same error for a field of `owner`.
    pub fn of(self, owner: &'static str) -> InvalidValue {
        InvalidValue { owner: Some(owner), ..self }
    }

    /// Returns an error unless `is_valid` holds.
    pub fn check(
        is_valid: bool,
        field: &'static str,
        rule: &'static str,
        value: impl Display,
    ) -> Result<(), InvalidValue> {
        if is_valid { Ok(()) } else { Err(InvalidValue::new(field, rule, value)) }
    }

    /// Returns an error if a number is not a share.
    pub fn check_share(field: &'static str, share: f32) -> Result<(), InvalidValue> {
        let is_share = (0.0..=1.0).contains(&share);
        InvalidValue::check(is_share, field, "must be a share from 0 to 1", share)
    }
}

impl Display for InvalidValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the {}", self.field)?;
        if let Some(owner) = self.owner {
            write!(f, " of the {owner}")?;
        }
        write!(f, " {}", self.rule)?;
        match &self.value {
            Some(value) => write!(f, " (given: {value})"),
            None => Ok(()),
        }
    }
}

/// The memory that a limit restricts.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum MemoryBudget {
    /// The memory of grids: `grid_bytes` of [`crate::sculpture::Limits`].
    Grids,
    /// The memory of colours: `colour_bytes` of these limits.
    Colours,
    /// Both together.
    GridsAndColours,
}

/// An error for work that needs more memory than its budget has. Nothing was allocated.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
pub struct OverBudget {
    /// The beginning of the message, with its verb: `the mesh needs at least`.
    pub what: Cow<'static, str>,
    /// MiB needed, as far as known.
    pub needed_mib: u64,
    /// MiB allowed.
    pub budget_mib: u64,
    /// The budget that was too small.
    pub budget: MemoryBudget,
    /// A remedy that needs no larger budget, if there is one.
    pub advice: Option<Cow<'static, str>>,
}

impl OverBudget {
    /// Returns an error for work that needs `needed` bytes.
    pub fn new(
        what: impl Into<Cow<'static, str>>,
        needed: u64,
        budget: MemoryBudget,
        budget_bytes: u64,
    ) -> OverBudget {
        OverBudget {
            what: what.into(),
            needed_mib: needed.div_ceil(1 << 20),
            budget_mib: budget_bytes >> 20,
            budget,
            advice: None,
        }
    }

    /// Returns an error if `needed` bytes are more than `budget_bytes`.
    pub fn check(
        what: impl Into<Cow<'static, str>>,
        needed: u64,
        budget: MemoryBudget,
        budget_bytes: u64,
    ) -> Result<(), OverBudget> {
        match needed > budget_bytes {
            true => Err(OverBudget::new(what, needed, budget, budget_bytes)),
            false => Ok(()),
        }
    }

    /// Returns the same error with another remedy.
    pub fn advise(self, advice: impl Into<Cow<'static, str>>) -> OverBudget {
        OverBudget { advice: Some(advice.into()), ..self }
    }
}

impl Display for OverBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (purpose, budget) = match self.budget {
            MemoryBudget::Grids => ("", "grids"),
            MemoryBudget::Colours => (" for colours", "them"),
            MemoryBudget::GridsAndColours => ("", "grids and colours"),
        };
        let OverBudget { what, needed_mib, budget_mib, .. } = self;
        write!(f, "{what} {needed_mib} MiB{purpose}, ")?;
        write!(f, "more than the {budget_mib} MiB allowed for {budget}")?;
        match &self.advice {
            Some(advice) => write!(f, "; {advice}"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_named_with_its_rule() {
        let hue = InvalidValue::new("hue", "must be turned by -360 to 360 degrees", 400.5);
        assert_eq!(hue.to_string(), "the hue must be turned by -360 to 360 degrees (given: 400.5)");
        let colour = InvalidValue::without_value("colour", "is missing").of("brush");
        assert_eq!(colour.to_string(), "the colour of the brush is missing");
    }

    #[test]
    fn memory_is_told_in_whole_mib() {
        let mesh = OverBudget::new("the mesh needs", 1, MemoryBudget::GridsAndColours, 1 << 20);
        let said = "the mesh needs 1 MiB, more than the 1 MiB allowed for grids and colours";
        assert_eq!(mesh.to_string(), said);
        let advised = mesh.advise("choose fewer voxels").to_string();
        assert_eq!(advised, format!("{said}; choose fewer voxels"));
        let colours = OverBudget::new("this may need", 5 << 20, MemoryBudget::Colours, 1 << 20);
        let said = "this may need 5 MiB for colours, more than the 1 MiB allowed for them";
        assert_eq!(colours.to_string(), said);
    }
}

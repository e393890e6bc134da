//! Describes a number, a choice or a colour of a brush: its name, its values, its texts. Panels, stored settings, pens
//! and the text form of commands are derived from these descriptions.
//!
//! A value is read by its [`Key`], which knows the type of its values. Knows no brush and no interface.

use std::fmt;
use std::marker::PhantomData;
use std::ops::RangeInclusive;

use crate::sculpture::Rgb;

/// A value of an option.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum OptionValue {
    /// No value.
    Absent,
    /// A number, in the unit of the option; shares from 0 to 1.
    Number(f32),
    /// A count.
    Whole(u32),
    /// A switch.
    On(bool),
    /// An index into the list of choices.
    Choice(u8),
    /// A colour.
    Colour(Rgb),
}

impl fmt::Display for OptionValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            OptionValue::Absent => f.write_str("nothing"),
            OptionValue::Number(number) => number.fmt(f),
            OptionValue::Whole(count) => count.fmt(f),
            OptionValue::On(on) => f.write_str(if *on { "on" } else { "off" }),
            OptionValue::Choice(place) => place.fmt(f),
            OptionValue::Colour(colour) => colour.fmt(f),
        }
    }
}

/// The values that an option can have.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Domain {
    /// The radius of the brush, in the unit that the user has chosen for the sizes of all brushes.
    Radius,
    /// Numbers in a range.
    Number([f32; 2]),
    /// Counts in a range.
    Whole([u32; 2]),
    /// On or off.
    Switch,
    /// One of a list of choices.
    Choice(&'static [Choice]),
    /// Any colour.
    Colour,
}

/// The meaning of an omitted value in a script.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Omitted {
    /// It cannot be left out.
    Required,
    /// This value, which the text form writes nevertheless.
    Is(OptionValue),
    /// This value, which the text form omits, too.
    Unwritten(OptionValue),
    /// This value, unless the script states the named parameter instead.
    InsteadOf(&'static str, OptionValue),
}

/// One of several values.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Choice {
    /// Used in scripts, in stored settings, and, capitalised, in panels.
    pub name: &'static str,
    /// Explains it in one sentence.
    pub help: &'static str,
}

/// The unit in which an option is shown.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Unit {
    /// A plain number.
    Plain,
    /// Pixels of the picture.
    Pixels,
    /// Smallest edges of a voxel.
    Voxels,
    /// A share from 0 to 1, shown in percent.
    Share,
}

impl Unit {
    /// Returns the factor by which a number is multiplied for display.
    pub fn factor(self) -> f32 {
        match self {
            Unit::Share => 100.0,
            Unit::Plain | Unit::Pixels | Unit::Voxels => 1.0,
        }
    }

    /// Returns the unit sign after the number, with the space before it.
    pub fn suffix(self) -> &'static str {
        match self {
            Unit::Plain => "",
            Unit::Pixels => " px",
            Unit::Voxels => " vx",
            Unit::Share => " %",
        }
    }
}

/// The description of an option.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Param {
    /// Used in scripts and in stored settings.
    pub key: &'static str,
    /// Shown in panels.
    pub label: &'static str,
    /// Explains it in one sentence.
    pub help: &'static str,
    /// Its domain.
    pub domain: Domain,
    /// The unit in which it is shown.
    pub unit: Unit,
    /// Its default in interactive use; for a radius in pixels.
    pub first: OptionValue,
    /// Its value in a script that omits it.
    pub omitted: Omitted,
    /// Whether sliders give small values more room.
    pub logarithmic: bool,
    /// Whether it requires a pointer on a screen.
    pub needs_pointer: bool,
}

impl Param {
    /// Returns whether the option can have a value. For a radius see [`Domain::Radius`]; `radii` is the range in the
    /// current unit.
    pub fn allows(&self, value: OptionValue, radii: RangeInclusive<f32>) -> bool {
        match (self.domain, value) {
            (Domain::Radius, OptionValue::Number(number)) => radii.contains(&number),
            (Domain::Number([least, most]), OptionValue::Number(number)) => {
                (least..=most).contains(&number)
            }
            (Domain::Whole([least, most]), OptionValue::Whole(count)) => {
                (least..=most).contains(&count)
            }
            (Domain::Switch, OptionValue::On(_)) | (Domain::Colour, OptionValue::Colour(_)) => true,
            (Domain::Choice(choices), OptionValue::Choice(place)) => {
                usize::from(place) < choices.len()
            }
            _ => false,
        }
    }

    /// Returns the rule for its values, to follow the name of the option.
    pub(super) fn rule(&self) -> String {
        match self.domain {
            Domain::Number([least, most]) => format!("must be from {least} to {most}"),
            Domain::Whole([least, most]) => format!("must be from {least} to {most}"),
            Domain::Choice(choices) => {
                let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
                format!("must be {}", names.join(" or "))
            }
            Domain::Radius => "must be a radius".to_string(),
            Domain::Switch => "must be on or off".to_string(),
            Domain::Colour => "must be a colour".to_string(),
        }
    }
}

/// A type of values of options.
pub trait ParamValue: Sized {
    /// Converts a value; `None` if it is of another type.
    fn from_value(value: OptionValue) -> Option<Self>;
    /// Converts to a value.
    fn to_value(self) -> OptionValue;
}

impl ParamValue for f32 {
    fn from_value(value: OptionValue) -> Option<f32> {
        if let OptionValue::Number(number) = value { Some(number) } else { None }
    }

    fn to_value(self) -> OptionValue {
        OptionValue::Number(self)
    }
}

impl ParamValue for u32 {
    fn from_value(value: OptionValue) -> Option<u32> {
        if let OptionValue::Whole(count) = value { Some(count) } else { None }
    }

    fn to_value(self) -> OptionValue {
        OptionValue::Whole(self)
    }
}

impl ParamValue for bool {
    fn from_value(value: OptionValue) -> Option<bool> {
        if let OptionValue::On(on) = value { Some(on) } else { None }
    }

    fn to_value(self) -> OptionValue {
        OptionValue::On(self)
    }
}

impl ParamValue for Rgb {
    fn from_value(value: OptionValue) -> Option<Rgb> {
        if let OptionValue::Colour(colour) = value { Some(colour) } else { None }
    }

    fn to_value(self) -> OptionValue {
        OptionValue::Colour(self)
    }
}

/// The key of an option whose values are of the type `T`, with the description that a brush adapts.
#[derive(Clone, Copy, Debug)]
pub struct Key<T> {
    /// The description.
    pub param: Param,
    values: PhantomData<fn() -> T>,
}

impl<T> Key<T> {
    /// Creates a key from a description whose values are of the type `T`.
    pub(super) const fn new(param: Param) -> Key<T> {
        Key { param, values: PhantomData }
    }

    /// Returns the same option under another label.
    pub(super) const fn label(mut self, label: &'static str) -> Key<T> {
        self.param.label = label;
        self
    }

    /// Returns the same option, explained for one brush.
    pub(super) const fn help(mut self, help: &'static str) -> Key<T> {
        self.param.help = help;
        self
    }

    /// Returns the same option, required in scripts.
    pub(super) const fn required(mut self) -> Key<T> {
        self.param.omitted = Omitted::Required;
        self
    }

    /// Returns the same option, optional in scripts.
    pub(super) const fn optional(mut self) -> Key<T> {
        self.param.omitted = Omitted::Unwritten(OptionValue::Absent);
        self
    }
}

impl Key<f32> {
    /// Returns the same option with another default.
    pub(super) const fn first(mut self, number: f32) -> Key<f32> {
        self.param.first = OptionValue::Number(number);
        self
    }

    /// Returns the same option with another range.
    pub(super) const fn range(mut self, least: f32, most: f32) -> Key<f32> {
        self.param.domain = Domain::Number([least, most]);
        self
    }
}

impl Key<u32> {
    /// Returns the same option with another default, in interactive use and in scripts.
    pub(super) const fn first(mut self, count: u32) -> Key<u32> {
        self.param.first = OptionValue::Whole(count);
        self.param.omitted = Omitted::Is(OptionValue::Whole(count));
        self
    }
}

impl Key<bool> {
    /// Returns the same option, on or off by default.
    pub(super) const fn first(mut self, on: bool) -> Key<bool> {
        self.param.first = OptionValue::On(on);
        self
    }
}

//! Describes a number, a choice or a colour of a brush: its name, its values, its texts. From these descriptions panels,
//! memory, pens and the text form of commands are made.
//!
//! A value is read by its [`Key`], which knows the type of its values. Knows no brush and no interface.

use std::fmt;
use std::marker::PhantomData;
use std::ops::RangeInclusive;

use crate::sculpture::Rgb;

/// A value of an option.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Value {
    /// There is none.
    Absent,
    /// A number, in the unit of the option; shares from 0 to 1.
    Number(f32),
    /// A count.
    Whole(u32),
    /// A switch.
    On(bool),
    /// A place in the list of choices.
    Choice(u8),
    /// A colour.
    Colour(Rgb),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Absent => f.write_str("nothing"),
            Value::Number(number) => number.fmt(f),
            Value::Whole(count) => count.fmt(f),
            Value::On(on) => f.write_str(if *on { "on" } else { "off" }),
            Value::Choice(place) => place.fmt(f),
            Value::Colour(colour) => colour.fmt(f),
        }
    }
}

/// The values that an option can have.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Domain {
    /// The radius of the brush, in the unit that the person has chosen for the sizes of all brushes.
    Radius,
    /// Numbers from a least to a largest one.
    Number([f32; 2]),
    /// Counts from a least to a largest one.
    Whole([u32; 2]),
    /// On or off.
    Switch,
    /// One of these.
    Choice(&'static [Choice]),
    /// Any colour.
    Colour,
}

/// The meaning of a script that says nothing about a value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Omitted {
    /// It cannot be left out.
    Required,
    /// It is this one, which the text form states nevertheless.
    Is(Value),
    /// It is this one, about which the text form says nothing either.
    Unwritten(Value),
    /// It is this one if the script does not state another parameter, which it names, instead.
    InsteadOf(&'static str, Value),
}

/// One of several values.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Choice {
    /// In scripts, in what is remembered, and, with a capital, in panels.
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
    /// Returns the factor by which a number is shown.
    pub fn factor(self) -> f32 {
        match self {
            Unit::Share => 100.0,
            Unit::Plain | Unit::Pixels | Unit::Voxels => 1.0,
        }
    }

    /// Returns the sign after the number, with the space before it.
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
    /// In scripts and in what is remembered.
    pub key: &'static str,
    /// In panels.
    pub label: &'static str,
    /// Explains it in one sentence.
    pub help: &'static str,
    /// Its values.
    pub domain: Domain,
    /// The unit in which it is shown.
    pub unit: Unit,
    /// Its first value in a hand; of a radius in pixels.
    pub first: Value,
    /// Its value in a script that says nothing about it.
    pub omitted: Omitted,
    /// Sliders give small values more room.
    pub logarithmic: bool,
    /// It makes no sense without a pointer on a screen.
    pub needs_pointer: bool,
}

impl Param {
    /// Returns whether the option can have a value. A radius: see [`Domain::Radius`]; `radii` are those of the unit in
    /// use.
    pub fn allows(&self, value: Value, radii: RangeInclusive<f32>) -> bool {
        match (self.domain, value) {
            (Domain::Radius, Value::Number(number)) => radii.contains(&number),
            (Domain::Number([least, most]), Value::Number(number)) => {
                (least..=most).contains(&number)
            }
            (Domain::Whole([least, most]), Value::Whole(count)) => (least..=most).contains(&count),
            (Domain::Switch, Value::On(_)) | (Domain::Colour, Value::Colour(_)) => true,
            (Domain::Choice(choices), Value::Choice(place)) => usize::from(place) < choices.len(),
            _ => false,
        }
    }

    /// Returns the rule that values keep, after the name of the option.
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
    /// From a value; none if it is of another type.
    fn from_value(value: Value) -> Option<Self>;
    /// As a value.
    fn to_value(self) -> Value;
}

impl ParamValue for f32 {
    fn from_value(value: Value) -> Option<f32> {
        if let Value::Number(number) = value { Some(number) } else { None }
    }

    fn to_value(self) -> Value {
        Value::Number(self)
    }
}

impl ParamValue for u32 {
    fn from_value(value: Value) -> Option<u32> {
        if let Value::Whole(count) = value { Some(count) } else { None }
    }

    fn to_value(self) -> Value {
        Value::Whole(self)
    }
}

impl ParamValue for bool {
    fn from_value(value: Value) -> Option<bool> {
        if let Value::On(on) = value { Some(on) } else { None }
    }

    fn to_value(self) -> Value {
        Value::On(self)
    }
}

impl ParamValue for Rgb {
    fn from_value(value: Value) -> Option<Rgb> {
        if let Value::Colour(colour) = value { Some(colour) } else { None }
    }

    fn to_value(self) -> Value {
        Value::Colour(self)
    }
}

/// The key of an option whose values are of the type `T`, with the description that a brush adapts to itself.
#[derive(Clone, Copy, Debug)]
pub struct Key<T> {
    /// The description.
    pub param: Param,
    values: PhantomData<fn() -> T>,
}

impl<T> Key<T> {
    /// Returns a key with a description whose values are of the type `T`.
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

    /// Returns the same in scripts that must state it.
    pub(super) const fn required(mut self) -> Key<T> {
        self.param.omitted = Omitted::Required;
        self
    }

    /// Returns the same in scripts that need not have it.
    pub(super) const fn optional(mut self) -> Key<T> {
        self.param.omitted = Omitted::Unwritten(Value::Absent);
        self
    }
}

impl Key<f32> {
    /// Returns the same option with another first value.
    pub(super) const fn first(mut self, number: f32) -> Key<f32> {
        self.param.first = Value::Number(number);
        self
    }

    /// Returns the same option with another range.
    pub(super) const fn range(mut self, least: f32, most: f32) -> Key<f32> {
        self.param.domain = Domain::Number([least, most]);
        self
    }
}

impl Key<u32> {
    /// Returns the same option with another first value, in a hand and in scripts.
    pub(super) const fn first(mut self, count: u32) -> Key<u32> {
        self.param.first = Value::Whole(count);
        self.param.omitted = Omitted::Is(Value::Whole(count));
        self
    }
}

impl Key<bool> {
    /// Returns the same option, on or off at first.
    pub(super) const fn first(mut self, on: bool) -> Key<bool> {
        self.param.first = Value::On(on);
        self
    }
}

//! The statements of a script as values, and their text by the manual's grammar.

use std::fmt;

use super::solid::Placed;
use super::symmetry::{Plane, Radial, Symmetry};

pub type Colour = [u8; 3];

/// The destinations of the x, y and z axes of a copy, and whether they are reversed.
pub type Axes = [(usize, bool); 3];

#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Area {
    Grid,
    Selection,
    Marker,
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Op {
    Add(Option<Colour>),
    Subtract,
    Recolour(Colour),
}

#[derive(Clone, Debug)]
pub enum MaskChange {
    Clear,
    Invert,
    Grow(usize),
    Shrink(usize),
    Put { adds: bool, what: MaskWhat },
}

#[derive(Clone, Debug)]
pub enum MaskWhat {
    Area(Area),
    Solid(Placed),
    Colour { colour: Colour, tolerance: f64 },
}

/// One ray along an axis, from outside through the centres of voxels.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ray {
    pub axis: usize,
    /// Towards higher voxels.
    pub rising: bool,
    /// The voxels that it passes through; the component of `axis` is ignored.
    pub through: [i64; 3],
}

#[derive(Clone, Debug)]
pub enum Statement {
    New {
        dims: [usize; 3],
        size: [f64; 3],
        bits: u32,
        base: Colour,
        solid: bool,
    },
    Begin,
    End,
    Cancel,
    Solid {
        op: Op,
        placed: Placed,
    },
    Brush {
        ray: Ray,
        colour: Colour,
    },
    Devour {
        ray: Ray,
        reach: f64,
    },
    /// Adds the voxels near those that the ray meets to the mask, or removes them.
    Protect {
        adds: bool,
        ray: Ray,
        reach: f64,
    },
    Mask(MaskChange),
    Fill {
        area: Area,
        colour: Option<Colour>,
    },
    Clear {
        area: Area,
    },
    Dye {
        area: Area,
        colour: Colour,
    },
    Mark {
        at: [i64; 3],
        size: [i64; 3],
    },
    Select {
        adds: bool,
    },
    Drop,
    ClearSelection,
    Limit(bool),
    Symmetry(Symmetry),
    Copy,
    Cut,
    Paste {
        at: [i64; 3],
        axes: Axes,
    },
    Move {
        by: [i64; 3],
        axes: Axes,
    },
    Array {
        count: usize,
        step: [i64; 3],
    },
    /// Orients the whole sculpture.
    Orient(Axes),
    Undo(Option<usize>),
    Redo(Option<usize>),
}

fn colour([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

pub fn list<T: fmt::Display>(values: &[T]) -> String {
    values.iter().map(T::to_string).collect::<Vec<_>>().join(",")
}

fn axes(axes: &Axes) -> String {
    let name = |&(axis, reversed): &(usize, bool)| {
        format!("{}{}", if reversed { "-" } else { "" }, ["x", "y", "z"][axis])
    };
    list(&axes.iter().map(name).collect::<Vec<_>>())
}

fn area(area: Area) -> &'static str {
    match area {
        Area::Grid => "grid",
        Area::Selection => "selection",
        Area::Marker => "marker",
    }
}

/// Returns the text of a ray. The spacing of rays does not matter to a single ray.
fn ray(ray: &Ray) -> String {
    let (mut across, mut down) = ([0.0; 3], [0.0; 3]);
    across[(ray.axis + 1) % 3] = 0.001;
    down[(ray.axis + 2) % 3] = 0.001;
    let (eye, aim) = (list(&ray.eye()), list(&ray.aim()));
    format!("eye={eye} aim={aim} across={} down={} radius=0", list(&across), list(&down))
}

fn steps(steps: &Option<usize>) -> String {
    steps.map_or("all".to_string(), |n| n.to_string())
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Statement::New { dims, size, bits, base, solid } => {
                let fill = if *solid { "solid" } else { "empty" };
                let (dims, size, base) = (list(dims), list(size), colour(*base));
                write!(f, "new dims={dims} size={size} colour={bits} base={base} fill={fill}")
            }
            Statement::Begin => write!(f, "begin \"a stroke\""),
            Statement::End => write!(f, "end"),
            Statement::Cancel => write!(f, "cancel"),
            Statement::Solid { op, placed } => match op {
                Op::Add(None) => write!(f, "add {placed}"),
                Op::Add(Some(c)) => write!(f, "add {placed} colour={}", colour(*c)),
                Op::Subtract => write!(f, "subtract {placed}"),
                Op::Recolour(c) => write!(f, "recolour {placed} colour={}", colour(*c)),
            },
            Statement::Brush { ray: r, colour: c } => {
                write!(f, "spray paintbrush {} colour={}", ray(r), colour(*c))
            }
            Statement::Devour { ray: r, reach } => {
                write!(f, "spray devourer {} reach={reach}", ray(r))
            }
            Statement::Protect { adds, ray: r, reach } => {
                let effect = if *adds { "mask" } else { "unmask" };
                write!(f, "spray {effect} {} reach={reach}", ray(r))
            }
            Statement::Mask(change) => write!(f, "mask {change}"),
            Statement::Fill { area: a, colour: None } => write!(f, "fill {}", area(*a)),
            Statement::Fill { area: a, colour: Some(c) } => {
                write!(f, "fill {} colour={}", area(*a), colour(*c))
            }
            Statement::Clear { area: a } => write!(f, "clear {}", area(*a)),
            Statement::Dye { area: a, colour: c } => {
                write!(f, "dye {} colour={}", area(*a), colour(*c))
            }
            Statement::Mark { at, size } => write!(f, "mark at={} size={}", list(at), list(size)),
            Statement::Select { adds: true } => write!(f, "select add"),
            Statement::Select { adds: false } => write!(f, "select subtract"),
            Statement::Drop => write!(f, "select drop"),
            Statement::ClearSelection => write!(f, "select clear"),
            Statement::Limit(on) => write!(f, "limit {}", if *on { "on" } else { "off" }),
            Statement::Symmetry(Symmetry { mirrors, plane, radial }) => {
                write!(f, "symmetry")?;
                for (axis, mirror) in ["x", "y", "z"].iter().zip(mirrors) {
                    let word = format!("{mirror:?}").to_lowercase();
                    write!(f, " {axis}={word}")?;
                }
                if let Some(Plane { at, normal }) = plane {
                    write!(f, " plane={} normal={}", list(at), list(normal))?;
                }
                if let Some(Radial { count, about, axis }) = radial {
                    write!(f, " radial={count} about={} axis={}", list(about), list(axis))?;
                }
                Ok(())
            }
            Statement::Copy => write!(f, "copy"),
            Statement::Cut => write!(f, "cut"),
            Statement::Paste { at, axes: a } => write!(f, "paste at={} axes={}", list(at), axes(a)),
            Statement::Move { by, axes: a } => write!(f, "move by={} axes={}", list(by), axes(a)),
            Statement::Array { count, step } => {
                write!(f, "array count={count} step={}", list(step))
            }
            Statement::Orient(a) => write!(f, "orient axes={}", axes(a)),
            Statement::Undo(n) => write!(f, "undo {}", steps(n)),
            Statement::Redo(n) => write!(f, "redo {}", steps(n)),
        }
    }
}

impl fmt::Display for MaskChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MaskChange::Clear => write!(f, "clear"),
            MaskChange::Invert => write!(f, "invert"),
            MaskChange::Grow(by) => write!(f, "grow by={by}"),
            MaskChange::Shrink(by) => write!(f, "shrink by={by}"),
            MaskChange::Put { adds, what } => {
                write!(f, "{} ", if *adds { "add" } else { "subtract" })?;
                match what {
                    MaskWhat::Area(a) => write!(f, "{}", area(*a)),
                    MaskWhat::Solid(placed) => write!(f, "{placed}"),
                    MaskWhat::Colour { colour: c, tolerance } => {
                        write!(f, "colour colour={} tolerance={tolerance}", colour(*c))
                    }
                }
            }
        }
    }
}

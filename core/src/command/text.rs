//! The text form of commands, one per line, and scripts of them.
//!
//! A line is a verb, then words, quoted strings and `key=value` pairs in any order. A line that is empty or begins with
//! `#` is ignored. Quotes and escapes: `arguments`. Numbers are written such that reading them returns the same bits.
//! Works on text; reads no file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use glam::{EulerRot, IVec3, Quat, UVec3, Vec3};
use thiserror::Error;

use arguments::{Arguments, Quoted, QuotedPath};

use crate::command::{COMMANDS, Command, NewSculpture};
use crate::format::base64;
use crate::sculpture::edit::EditOp;
use crate::sculpture::{ColourDepth, Placement, Rgb};
use crate::tools::drawn::DrawnSolid;
use crate::tools::solid::{Primitive, Solid};

mod arguments;
mod brush;
mod canvas;
mod drawn_solid;
mod export;
mod import;
mod mask;
mod repair;
mod resample;
mod selection;
mod tint;

pub use brush::usage_of as usage_of_brush;
pub(super) use brush::{usage as usage_of_brushes, verb as verb_of_brush};
pub use drawn_solid::usage as usage_of_drawn_solid;

/// The default base colour of new sculptures.
pub const DEFAULT_BASE: Rgb = Rgb::STONE;

/// The error in a line.
#[derive(Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct ParseError(String);

/// The error in a script, and its line.
#[derive(Debug, Error, PartialEq, Eq)]
#[error("line {line}: {error}")]
pub struct ScriptError {
    /// Counted from 1.
    pub line: usize,
    /// The error in that line.
    pub error: ParseError,
}

/// Reads a script: the commands with their line numbers (from 1).
pub fn parse_script(text: &str) -> Result<Vec<(usize, Command)>, ScriptError> {
    let mut commands = Vec::new();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (i, line) in text.lines().enumerate() {
        let trimmed = line.trim();
        if trimmed.is_empty() || trimmed.starts_with('#') {
            continue;
        }
        let command = trimmed.parse().map_err(|error| ScriptError { line: i + 1, error })?;
        commands.push((i + 1, command));
    }
    Ok(commands)
}

/// Returns the text form of a file name with any bytes: one word of a command.
pub fn path_text(path: &Path) -> String {
    QuotedPath(path).to_string()
}

/// Reads the text form that [`path_text`] writes.
pub(crate) fn parse_path(text: &str) -> Result<PathBuf, ParseError> {
    let mut args = Arguments::parse(&format!("open {text}"))?;
    let path = args.path()?;
    args.finish().map(|()| path)
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.verb())?;
        match self {
            Command::New(new) => write_new(new, f),
            Command::Open { path, import } => {
                write!(f, " {}", QuotedPath(path))?;
                import::write(import, f)
            }
            Command::Embed { path, file } => {
                write!(f, " {} data={}", QuotedPath(path), base64::encode(file))
            }
            Command::Save { path, export } => {
                write!(f, " {}", QuotedPath(path))?;
                export::write(export, f)
            }
            Command::Begin { label } => write!(f, " {}", Quoted(label)),
            Command::Construct { op, primitive, to_vx } => {
                write_placed(primitive, *to_vx, f)?;
                write_colour(op, f)
            }
            Command::DrawnSolid { op, drawn } => {
                drawn_solid::write(drawn, f)?;
                write_colour(op, f)
            }
            Command::Brush(used) => brush::write(used, f),
            Command::Texture { primitive, picture } => {
                write!(f, " {} {primitive}", QuotedPath(picture))
            }
            Command::Fill { area, colour } => {
                write!(f, " {}", area.name())?;
                colour.map_or(Ok(()), |colour| write!(f, " colour={colour}"))
            }
            Command::Clear { area } => write!(f, " {}", area.name()),
            Command::Dye { area, colour } => write!(f, " {} colour={colour}", area.name()),
            Command::Tint { area, tint } => tint::write(*area, tint, f),
            Command::Flood { at, colour, tolerance } => {
                tint::write_flood(*at, *colour, *tolerance, f)
            }
            Command::Mask(change) => mask::write(change, f),
            Command::Mark(_)
            | Command::Select(_)
            | Command::Limit(_)
            | Command::Symmetry(_)
            | Command::Irreversible(_)
            | Command::Paste { .. }
            | Command::Move { .. }
            | Command::Array { .. }
            | Command::Orient(_)
            | Command::Surface(_) => selection::write(self, f),
            Command::Canvas(change) => canvas::write(change, f),
            Command::Resample(to) => resample::write(to, f),
            Command::Repair(repair) => repair::write(repair, f),
            Command::Undo { steps } | Command::Redo { steps } => match steps {
                Some(n) => write!(f, " {n}"),
                None => write!(f, " all"),
            },
            Command::Place(placement) => write_placement(placement, f),
            Command::End | Command::Cancel | Command::Copy | Command::Cut => Ok(()),
        }
    }
}

fn write_new(new: &NewSculpture, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, " dims={} size={}", list(new.dims.to_array()), list(new.voxel_size.to_array()))?;
    let fill = if new.solid { "solid" } else { "empty" };
    write!(f, " colour={} base={} fill={fill}", new.colour_depth.bits(), new.base)?;
    if new.room_vx > 0 {
        write!(f, " room={}", new.room_vx)?;
    }
    if new.grows { f.write_str(" grow=on") } else { Ok(()) }
}

fn write_placement(p: &Placement, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let (turn, by) = (list(p.rotation.to_array()), list(p.translation.to_array()));
    write!(f, " turn={turn} move={by} scale={}", p.scale)
}

fn write_placed(
    primitive: &Primitive,
    to_vx: Option<Vec3>,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    write!(f, " {primitive}")?;
    to_vx.map_or(Ok(()), |to| write!(f, " to={}", list(to.to_array())))
}

fn write_colour(op: &EditOp, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match op {
        EditOp::Add(Some(colour)) | EditOp::Recolour(colour) => write!(f, " colour={colour}"),
        EditOp::Add(None) | EditOp::Subtract => Ok(()),
    }
}

impl fmt::Display for Primitive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} at={} half={} turn={}",
            self.solid.name(),
            list(self.centre_vx.to_array()),
            list(self.half.to_array()),
            list(self.rotation.to_array())
        )
    }
}

impl FromStr for Command {
    type Err = ParseError;

    fn from_str(line: &str) -> Result<Command, ParseError> {
        let mut args = Arguments::parse(line)?;
        let verb = args.verb.clone();
        let command = match verb.as_str() {
            "new" => Command::New(parse_new(&mut args)?),
            "open" => Command::Open { path: args.path()?, import: import::parse(&mut args)? },
            "embed" => {
                let data = |text: &str| {
                    let file = base64::decode(text.as_bytes(), text.len());
                    file.ok_or_else(|| "this is no Base64 text".to_string())
                };
                Command::Embed { path: args.path()?, file: args.required("data", data)?.into() }
            }
            "save" => Command::Save { path: args.path()?, export: export::parse(&mut args)? },
            "begin" => Command::Begin { label: args.optional_word()?.unwrap_or("stroke".into()) },
            "end" => Command::End,
            "cancel" => Command::Cancel,
            "add" | "subtract" | "recolour" => parse_construct(&verb, &mut args)?,
            "spray" | "deform" | "grab" | "stencil" => {
                Command::Brush(brush::parse(&verb, &mut args)?)
            }
            "texture" => {
                Command::Texture { picture: args.path()?, primitive: parse_primitive(&mut args)? }
            }
            "fill" => Command::Fill {
                area: selection::parse_area(&mut args)?,
                colour: args.optional("colour", parse_colour)?,
            },
            "clear" => Command::Clear { area: selection::parse_area(&mut args)? },
            "dye" => Command::Dye {
                area: selection::parse_area(&mut args)?,
                colour: args.required("colour", parse_colour)?,
            },
            "adjust" | "gradient" | "noise" => tint::parse(&verb, &mut args)?,
            "flood" => tint::parse_flood(&mut args)?,
            "mask" => mask::parse(&mut args)?,
            "mark" | "select" | "limit" | "irreversible" | "symmetry" | "copy" | "cut"
            | "paste" | "move" | "array" | "orient" | "surface" => {
                selection::parse(&verb, &mut args)?
            }
            "resample" => Command::Resample(resample::parse(&mut args)?),
            "canvas" => Command::Canvas(canvas::parse(&mut args)?),
            "remove-islands" | "fill-cavities" | "thicken" | "drain" => {
                repair::parse(&verb, &mut args)?
            }
            "undo" => Command::Undo { steps: parse_steps(&mut args)? },
            "redo" => Command::Redo { steps: parse_steps(&mut args)? },
            "place" => Command::Place(Placement {
                rotation: args.optional("turn", parse_rotation)?.unwrap_or(Quat::IDENTITY),
                translation: args.optional("move", parse_vec3)?.unwrap_or(Vec3::ZERO),
                scale: args.optional("scale", number)?.unwrap_or(1.0),
            }),
            _ => {
                let known: Vec<&str> = COMMANDS.iter().map(|c| c.verb).collect();
                return Err(ParseError(format!(
                    "unknown command `{verb}`; the commands are {}",
                    known.join(", ")
                )));
            }
        };
        args.finish()?;
        Ok(command)
    }
}

fn parse_new(args: &mut Arguments) -> Result<NewSculpture, ParseError> {
    Ok(NewSculpture {
        dims: args.required("dims", |text| {
            let [x, y, z] = numbers::<u32, 3>(text)?;
            Ok(UVec3::new(x, y, z))
        })?,
        voxel_size: args.optional("size", parse_vec3)?.unwrap_or(Vec3::ONE),
        colour_depth: args.optional("colour", parse_colour_depth)?.unwrap_or_default(),
        base: args.optional("base", parse_colour)?.unwrap_or(DEFAULT_BASE),
        solid: args
            .optional("fill", |text| match text {
                "solid" => Ok(true),
                "empty" => Ok(false),
                _ => Err("must be solid or empty".to_string()),
            })?
            .unwrap_or(true),
        room_vx: args.optional("room", number)?.unwrap_or(0),
        grows: args
            .optional("grow", |text| selection::is_on(text).ok_or("must be on or off".into()))?
            .unwrap_or(false),
    })
}

/// Reads which of two words is given. Returns false for the first, which is the default.
fn choice(args: &mut Arguments, key: &str, words: [&str; 2]) -> Result<bool, ParseError> {
    let parse = |text: &str| match words.iter().position(|word| *word == text) {
        Some(place) => Ok(place == 1),
        None => Err(format!("must be {} or {}", words[0], words[1])),
    };
    args.optional(key, parse).map(Option::unwrap_or_default)
}

fn parse_primitive(args: &mut Arguments) -> Result<Primitive, ParseError> {
    let name = args.word(Solid::names())?;
    parse_placed(&name, args, Solid::names())
}

/// Reads the arguments after the name of a solid, which is one of `names`.
fn parse_placed(name: &str, args: &mut Arguments, names: &str) -> Result<Primitive, ParseError> {
    let solid = Solid::named(name)
        .ok_or_else(|| ParseError(format!("`{name}` is not a solid; use {names}")))?;
    Ok(Primitive {
        solid,
        centre_vx: args.required("at", parse_vec3)?,
        half: args.required("half", |text| match text.contains(',') {
            true => parse_vec3(text),
            false => number(text).map(Vec3::splat),
        })?,
        rotation: args.optional("turn", parse_rotation)?.unwrap_or(Quat::IDENTITY),
    })
}

/// Returns the names of all solids, in a box and drawn, for messages.
fn solid_names() -> String {
    let names = Solid::ALL.iter().map(|solid| solid.name());
    alternatives(names.chain(DrawnSolid::ALL.iter().map(|spec| spec.name)))
}

/// Joins names with commas, and `or` before the last.
pub(super) fn alternatives(names: impl Iterator<Item = &'static str>) -> String {
    let names: Vec<&str> = names.collect();
    match names.split_last() {
        Some((last, [])) => last.to_string(),
        Some((last, first)) => format!("{} or {last}", first.join(", ")),
        None => String::new(),
    }
}

fn parse_construct(verb: &str, args: &mut Arguments) -> Result<Command, ParseError> {
    let names = solid_names();
    let name = args.word(&names)?;
    let op = |args: &mut Arguments| -> Result<EditOp, ParseError> {
        Ok(match verb {
            "add" => EditOp::Add(args.optional("colour", parse_colour)?),
            "recolour" => EditOp::Recolour(args.required("colour", parse_colour)?),
            _ => EditOp::Subtract,
        })
    };
    if let Some(drawn) = drawn_solid::parse(&name, args)? {
        return Ok(Command::DrawnSolid { op: op(args)?, drawn });
    }
    let (primitive, to_vx) = parse_swept(&name, args, &names)?;
    Ok(Command::Construct { op: op(args)?, primitive, to_vx })
}

/// Reads the arguments after the name of a solid that may sweep.
fn parse_swept(
    name: &str,
    args: &mut Arguments,
    names: &str,
) -> Result<(Primitive, Option<Vec3>), ParseError> {
    Ok((parse_placed(name, args, names)?, args.optional("to", parse_vec3)?))
}

fn parse_steps(args: &mut Arguments) -> Result<Option<u32>, ParseError> {
    match args.optional_word()?.as_deref() {
        None => Ok(Some(1)),
        Some("all") => Ok(None),
        Some(text) => number(text)
            .map(Some)
            .map_err(|_| ParseError(format!("`{text}` is neither a number of steps nor `all`"))),
    }
}

/// Reads three angles in degrees about x, then y, then z; or a quaternion x, y, z, w.
fn parse_rotation(text: &str) -> Result<Quat, String> {
    if let Ok(degrees) = numbers::<f32, 3>(text) {
        let [x, y, z] = degrees.map(f32::to_radians);
        return Ok(Quat::from_euler(EulerRot::XYZEx, x, y, z));
    }
    let quat = numbers::<f32, 4>(text).map(Quat::from_array).map_err(|_| {
        "must be three angles in degrees or a quaternion of four numbers".to_string()
    })?;
    // The bits of a written rotation are kept; a typed one is normalised.
    match quat.is_normalized() {
        true => Ok(quat),
        // Squares of large numbers overflow in single precision.
        false if quat.as_dquat().length_squared() > 1e-12 => {
            Ok(quat.as_dquat().normalize().as_quat())
        }
        false => Err("must not be a quaternion of length 0".to_string()),
    }
}

fn parse_colour_depth(text: &str) -> Result<ColourDepth, String> {
    let depth = number(text).ok().and_then(ColourDepth::from_bits);
    depth.ok_or_else(|| "must be 0, 8, 16 or 24 bits".to_string())
}

fn parse_colour(text: &str) -> Result<Rgb, String> {
    text.parse()
}

fn parse_vec3(text: &str) -> Result<Vec3, String> {
    numbers::<f32, 3>(text).map(Vec3::from_array)
}

/// Reads the place of a voxel. Coordinates that no sculpture has become the nearest ones of the type.
fn parse_place(text: &str) -> Result<IVec3, String> {
    let near = |v: i64| v.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32;
    numbers::<i64, 3>(text).map(|place| IVec3::from_array(place.map(near)))
}

fn parse_ivec3(text: &str) -> Result<IVec3, String> {
    numbers::<i32, 3>(text).map(IVec3::from_array)
}

fn numbers<T: CommandNumber, const N: usize>(text: &str) -> Result<[T; N], String> {
    let values: Vec<T> = text.split(',').map(number).collect::<Result<_, _>>()?;
    values.try_into().map_err(|_| format!("must be {N} numbers separated by commas"))
}

fn number<T: CommandNumber>(text: &str) -> Result<T, String> {
    match text.trim().parse::<T>() {
        Ok(value) if value.usable() => Ok(value),
        _ => Err(format!("`{text}` is not a valid number")),
    }
}

/// A number that a command may hold.
trait CommandNumber: FromStr {
    fn usable(&self) -> bool;
}

impl CommandNumber for f32 {
    fn usable(&self) -> bool {
        self.is_finite()
    }
}

impl CommandNumber for u32 {
    fn usable(&self) -> bool {
        true
    }
}

impl CommandNumber for i32 {
    fn usable(&self) -> bool {
        true
    }
}

impl CommandNumber for i64 {
    fn usable(&self) -> bool {
        true
    }
}

impl CommandNumber for u64 {
    fn usable(&self) -> bool {
        true
    }
}

fn list<T: fmt::Display, const N: usize>(values: [T; N]) -> String {
    values.map(|v| v.to_string()).join(",")
}

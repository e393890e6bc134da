//! The text form of brushes, made from their descriptions: `spray` for an outline, `stencil` for an image, `grab` for a
//! pull, and `deform` for a ball.

use std::fmt;

use super::arguments::Arguments;
use super::{ParseError, QuotedPath, list, number, parse_colour, parse_vec3};
use crate::tools::brush::footprint::{Coverage, Footprint, Outline};
use crate::tools::brush::param::{Domain, Omitted, OptionValue, Param};
use crate::tools::brush::spec::ContactKind;
use crate::tools::brush::{BrushBall, BrushDirection, BrushId, BrushSurface, BrushUse, Contact};

const SPRAY: &str = "spray";
const STENCIL: &str = "stencil";
const DEFORM: &str = "deform";
const GRAB: &str = "grab";

/// Returns the verb of a brush use.
pub fn verb(used: &BrushUse) -> &'static str {
    match used.picture {
        Some(_) => STENCIL,
        None => verb_at(used.contact.kind()),
    }
}

/// Returns the verb of brushes with this kind of contact.
const fn verb_at(contact: ContactKind) -> &'static str {
    match contact {
        ContactKind::Footprint => SPRAY,
        ContactKind::BallWithDisplacement => GRAB,
        ContactKind::Ball | ContactKind::BallWithNormal => DEFORM,
    }
}

/// Returns the command of a brush, for the manual; `None` if a hand's commands are those of another brush.
pub fn usage_of(brush: BrushId) -> Option<String> {
    let verb = verb_at(brush.spec().script?.contact);
    Some(format!("{verb} {}", usage_with(verb, &[brush])))
}

/// Returns the arguments of a verb of brushes, for help.
pub fn usage(verb: &str) -> String {
    usage_with(verb, &brushes_of(verb))
}

fn usage_with(verb: &str, brushes: &[BrushId]) -> String {
    let rays = "eye=X,Y,Z aim=X,Y,Z across=X,Y,Z down=X,Y,Z radius=RAYS";
    let ball = "at=X,Y,Z radius=VOXELS";
    let params = |brushes: &[BrushId]| params_of(brushes).join(" ");
    let names = |brushes: &[BrushId]| -> String {
        let names: Vec<&str> = brushes.iter().map(|brush| brush.spec().name).collect();
        names.join("|")
    };
    let is_normal = |brush: &BrushId| {
        brush.spec().script.is_some_and(|script| script.contact == ContactKind::BallWithNormal)
    };
    let normal = match brushes.iter().filter(|brush| is_normal(brush)).count() {
        0 => "",
        some if some == brushes.len() => " normal=X,Y,Z",
        _ => " [normal=X,Y,Z]",
    };
    match verb {
        STENCIL => {
            format!("\"PICTURE\" {rays} [takes=rays|visible] [colour=#rrggbb] [cover=0..1]")
        }
        GRAB => {
            format!("{ball} by=DX,DY,DZ {} [surface=now|stroke]", params(brushes))
        }
        SPRAY => format!(
            "{} {rays} [outline=round|square] [takes=rays|visible] {} [surface=now|stroke]",
            names(brushes),
            params(brushes)
        ),
        _ => format!("{} {ball}{normal} {} [surface=now|stroke]", names(brushes), params(brushes)),
    }
}

/// Returns the parameters of brushes, in brackets unless all of them require it.
fn params_of(brushes: &[BrushId]) -> Vec<String> {
    let mut params: Vec<&Param> = Vec::new();
    for param in brushes.iter().flat_map(|brush| brush.spec().params()) {
        if params.iter().all(|known| known.key != param.key) {
            params.push(param);
        }
    }
    let is_required = |key: &str| {
        brushes.iter().all(|brush| {
            let own = brush.spec().params().iter().find(|param| param.key == key);
            own.is_some_and(|param| param.omitted == Omitted::Required)
        })
    };
    let text = |param: &Param| {
        let values = match param.domain {
            Domain::Number([least, most]) => format!("{least}..{most}"),
            Domain::Whole([least, most]) => format!("{least}..{most}"),
            Domain::Choice(choices) => {
                let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
                names.join("|")
            }
            Domain::Colour => "#rrggbb".to_string(),
            Domain::Switch => "on|off".to_string(),
            Domain::Radius => "VOXELS".to_string(),
        };
        match is_required(param.key) {
            true => format!("{}={values}", param.key),
            false => format!("[{}={values}]", param.key),
        }
    };
    params.into_iter().map(text).collect()
}

/// Writes the arguments after the verb.
pub fn write(used: &BrushUse, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let verb = verb(used);
    match &used.picture {
        Some(picture) => write!(f, " {}", QuotedPath(picture))?,
        None if verb != GRAB => write!(f, " {}", used.brush().spec().name)?,
        None => {}
    }
    let mut params = used.iter();
    match &used.contact {
        Contact::Footprint(footprint) => {
            write_rays(footprint, f)?;
            // An image has an outline itself, and reaches no deeper than the visible surface.
            let reach = params.next().filter(|_| verb != STENCIL);
            if let Some((param, value)) = reach {
                write!(f, " outline={}", footprint.outline.name())?;
                write_value(param, value, f)?;
                write_surface(used.surface, f)?;
            }
            params.try_for_each(|(param, value)| write_value(param, value, f))
        }
        Contact::Ball(BrushBall { centre_vx, radius, frame }) => {
            write!(f, " at={} radius={radius}", list(centre_vx.to_array()))?;
            match frame {
                BrushDirection::None => {}
                BrushDirection::Normal(normal) => write!(f, " normal={}", list(normal.to_array()))?,
                BrushDirection::Displacement(by_vx) => write!(f, " by={}", list(by_vx.to_array()))?,
            }
            params.try_for_each(|(param, value)| write_value(param, value, f))?;
            write_surface(used.surface, f)
        }
    }
}

fn write_rays(footprint: &Footprint, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Footprint { eye_vx, aim, across, down, radius, .. } = footprint;
    for (key, vector) in [("eye", eye_vx), ("aim", aim), ("across", across), ("down", down)] {
        write!(f, " {key}={}", list(vector.to_array()))?;
    }
    write!(f, " radius={radius}")?;
    match footprint.coverage {
        // Recordings from before there was another coverage do not state it.
        Coverage::Rays => Ok(()),
        coverage => write!(f, " takes={}", coverage.name()),
    }
}

fn write_surface(surface: BrushSurface, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match surface {
        BrushSurface::Now => Ok(()),
        BrushSurface::Stroke => write!(f, " surface=stroke"),
    }
}

fn write_value(param: &Param, value: OptionValue, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    if param.omitted == Omitted::Unwritten(value) {
        return Ok(());
    }
    let key = param.key;
    match (value, param.domain) {
        (OptionValue::Absent, _) => Ok(()),
        (OptionValue::Number(number), _) => write!(f, " {key}={number}"),
        (OptionValue::Whole(count), _) => write!(f, " {key}={count}"),
        (OptionValue::On(on), _) => write!(f, " {key}={}", if on { "on" } else { "off" }),
        (OptionValue::Colour(colour), _) => write!(f, " {key}={colour}"),
        (OptionValue::Choice(place), Domain::Choice(choices)) => {
            let name = choices.get(usize::from(place)).map_or("", |choice| choice.name);
            write!(f, " {key}={name}")
        }
        (OptionValue::Choice(_), _) => Err(fmt::Error),
    }
}

/// Reads the arguments after a verb of brushes.
pub fn parse(verb: &str, args: &mut Arguments) -> Result<BrushUse, ParseError> {
    match verb {
        STENCIL => parse_stencil(args),
        GRAB => parse_use(BrushId::Grab, args),
        _ => {
            let brush = named(args, verb)?;
            parse_use(brush, args)
        }
    }
}

/// Returns the brushes that a verb names.
fn brushes_of(verb: &str) -> Vec<BrushId> {
    let is_of_verb =
        |brush: &BrushId| brush.spec().script.is_some_and(|script| verb_at(script.contact) == verb);
    BrushId::ALL.iter().copied().filter(is_of_verb).collect()
}

/// Reads the next word as the name of a brush of the verb.
fn named(args: &mut Arguments, verb: &str) -> Result<BrushId, ParseError> {
    let all = brushes_of(verb);
    let names: Vec<&str> = all.iter().map(|brush| brush.spec().name).collect();
    let name = args.word(&format!("a brush, such as {}", names.first().unwrap_or(&"")))?;
    all.into_iter().find(|brush| brush.spec().name == name).ok_or_else(|| {
        ParseError(format!("`{name}` is not a brush of `{verb}`; use {}", names.join(", ")))
    })
}

fn parse_use(brush: BrushId, args: &mut Arguments) -> Result<BrushUse, ParseError> {
    let contact = brush.spec().script.map_or(ContactKind::Ball, |script| script.contact);
    let contact = match contact {
        ContactKind::Footprint => {
            let outline = args.optional("outline", parse_outline)?.unwrap_or_default();
            Contact::Footprint(parse_rays(args, outline)?)
        }
        ContactKind::Ball => Contact::Ball(parse_ball(args, BrushDirection::None)?),
        ContactKind::BallWithNormal => {
            let normal = args.required("normal", parse_vec3)?;
            Contact::Ball(parse_ball(args, BrushDirection::Normal(normal))?)
        }
        ContactKind::BallWithDisplacement => {
            let by_vx = args.required("by", parse_vec3)?;
            Contact::Ball(parse_ball(args, BrushDirection::Displacement(by_vx))?)
        }
    };
    let mut used = BrushUse::new(brush, contact);
    for param in brush.spec().params() {
        read_value(param, param.omitted == Omitted::Required, &mut used, args)?;
    }
    for param in brush.spec().params() {
        let is_given = |key: &str| used.value(key).is_some();
        if let Omitted::InsteadOf(other, _) = param.omitted
            && is_given(param.key)
            && is_given(other)
        {
            return Err(ParseError(format!("`{}=` stands instead of `{other}=`", param.key)));
        }
    }
    used.surface = parse_surface(args)?;
    Ok(used.completed())
}

/// Reads the arguments after the verb of a stencil.
fn parse_stencil(args: &mut Arguments) -> Result<BrushUse, ParseError> {
    let picture = args.path()?;
    let footprint = parse_rays(args, Outline::Square)?;
    let mut used = BrushUse::under(BrushId::Paint, footprint);
    used.picture = Some(picture);
    // Without the reach, which is the first.
    for param in BrushId::Paint.spec().params().iter().skip(1) {
        read_value(param, false, &mut used, args)?;
    }
    Ok(used)
}

fn parse_rays(args: &mut Arguments, outline: Outline) -> Result<Footprint, ParseError> {
    Ok(Footprint {
        eye_vx: args.required("eye", parse_vec3)?,
        aim: args.required("aim", parse_vec3)?,
        across: args.required("across", parse_vec3)?,
        down: args.required("down", parse_vec3)?,
        radius: args.required("radius", number)?,
        outline,
        coverage: args.optional("takes", parse_coverage)?.unwrap_or_default(),
    })
}

fn parse_ball(args: &mut Arguments, frame: BrushDirection) -> Result<BrushBall, ParseError> {
    Ok(BrushBall {
        centre_vx: args.required("at", parse_vec3)?,
        radius: args.required("radius", number)?,
        frame,
    })
}

fn read_value(
    param: &Param,
    required: bool,
    used: &mut BrushUse,
    args: &mut Arguments,
) -> Result<(), ParseError> {
    let parse = |text: &str| parse_value(param, text);
    let value = match required {
        true => Some(args.required(param.key, parse)?),
        false => args.optional(param.key, parse)?,
    };
    if let Some(value) = value {
        used.set_value(param.key, value);
    }
    Ok(())
}

fn parse_value(param: &Param, text: &str) -> Result<OptionValue, String> {
    match param.domain {
        Domain::Radius | Domain::Number(_) => number(text).map(OptionValue::Number),
        Domain::Whole(_) => number(text).map(OptionValue::Whole),
        Domain::Colour => parse_colour(text).map(OptionValue::Colour),
        Domain::Switch => match text {
            "on" => Ok(OptionValue::On(true)),
            "off" => Ok(OptionValue::On(false)),
            _ => Err("must be on or off".to_string()),
        },
        Domain::Choice(choices) => {
            let place = choices.iter().position(|choice| choice.name == text);
            let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
            let place = place.ok_or_else(|| format!("must be {}", names.join(" or ")))?;
            Ok(OptionValue::Choice(place as u8))
        }
    }
}

/// Reads which surface is meant: by default the present one.
fn parse_surface(args: &mut Arguments) -> Result<BrushSurface, ParseError> {
    let surface = args.optional("surface", |text| match text {
        "now" => Ok(BrushSurface::Now),
        "stroke" => Ok(BrushSurface::Stroke),
        _ => Err("must be now or stroke".to_string()),
    })?;
    Ok(surface.unwrap_or_default())
}

fn parse_coverage(text: &str) -> Result<Coverage, String> {
    let coverage = Coverage::ALL.into_iter().find(|coverage| coverage.name() == text);
    coverage.ok_or_else(|| "must be rays or visible".to_string())
}

fn parse_outline(text: &str) -> Result<Outline, String> {
    let outline = Outline::ALL.into_iter().find(|outline| outline.name() == text);
    outline.ok_or_else(|| "must be round or square".to_string())
}

//! Groups of arguments that several jobs share, and the parsers of single values with their error
//! messages.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PathBufValueParser, TypedValueParser};
use glam::Vec3;

use crate::format::meshes_read_with_up_text;
use crate::format::options::{
    Colouring, Cubic, Existence, ImportOptions, MeshFill, MeshSize, Ordinal, RawLayout, ScanRegion,
};
use crate::headless::PictureRequest;
use crate::render::RenderMode;
use crate::sculpture::orientation::Up;
use crate::sculpture::{ColourDepth, Rgb};
use crate::shade::ground::GROUND_COLOUR;
use crate::trace::MAX_FINAL_SAMPLES;
use crate::view::{MAX_SAMPLES, StereoLayout};

use super::choices;
use super::error::ArgumentError;

/// How a file becomes a sculpture.
#[derive(Args, Debug, Clone)]
pub struct ImportArgs {
    /// Density from which voxels are filled: auto, a number in the units of the file, or two such as 300..1200
    #[arg(long, default_value_t, value_name = "DENSITY", allow_hyphen_values = true)]
    pub threshold: Existence,
    /// How voxels are coloured: auto, none, grey, tissue, labels or packed
    #[arg(long, alias = "coloring", default_value_t, value_name = "HOW")]
    pub colouring: Colouring,
    /// Colour bits per voxel: 0, 8, 16 or 24 (default: as in the file)
    #[arg(long, alias = "color-bits", value_name = "BITS", value_parser = parse_colour_bits)]
    pub colour_bits: Option<ColourDepth>,
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, help = upright_help())]
    pub upright: Option<Up>,
    /// Layout of a raw file: WIDTHxHEIGHTxDEPTH:TYPE[:skip=BYTES][:size=SX,SY,SZ]
    #[arg(long, value_name = "LAYOUT")]
    pub raw: Option<RawLayout>,
    /// Channel to read from a TIFF file with several, counted from 1 (default: the first)
    #[arg(long, value_name = "N")]
    pub channel: Option<Ordinal>,
    /// Time point to read from a scan with several, or phase, echo, or volume along a fourth axis, counted from 1 (default: the
    /// first, or that of the named DICOM file)
    #[arg(long, value_name = "N")]
    pub time: Option<Ordinal>,
    /// Part of a volume to read: its lowest and highest voxel in the file, such as 0,0,10..127,127,60
    #[arg(long, value_name = "REGION")]
    pub region: Option<ScanRegion>,
    /// Resample a volume to cubic voxels: no, finest (its shortest edge), or an edge such as 0.5mm
    #[arg(long, default_value_t, value_name = "EDGE")]
    pub cubic: Cubic,
    /// Take only the largest set of voxels of a volume that are connected by their faces
    #[arg(long)]
    pub largest_piece: bool,
    /// Fill the empty spaces inside a volume that do not reach its border
    #[arg(long)]
    pub fill_holes: bool,
    /// Size of a mesh: voxels of its longest side, or the edge of a voxel such as 0.5mm
    #[arg(long, default_value_t, value_name = "SIZE")]
    pub mesh_size: MeshSize,
    /// Inside of a mesh: auto (solid, but only the surface of an open mesh), solid or shell
    #[arg(long, default_value_t, value_name = "HOW")]
    pub mesh_fill: MeshFill,
}

fn upright_help() -> String {
    let z = meshes_read_with_up_text(Up::Z);
    format!(
        "Axis that points up in a file that does not specify it: y, z, -z, -y, x or -x (default: z in {z}, else y)"
    )
}

impl ImportArgs {
    pub fn options(&self) -> ImportOptions {
        ImportOptions {
            existence: self.threshold,
            colouring: self.colouring,
            colour_depth: self.colour_bits,
            upright: self.upright,
            raw: self.raw,
            channel: self.channel,
            time: self.time,
            region: self.region,
            cubic: self.cubic,
            largest_piece: self.largest_piece,
            fill_holes: self.fill_holes,
            mesh_size: self.mesh_size,
            mesh_fill: self.mesh_fill,
        }
    }
}

/// Parses a file to write, whose extension must be one of `endings`, so that a slip does not overwrite another file.
pub(super) fn named(endings: &'static [&'static str]) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.is_some_and(|ending| endings.contains(&ending.as_str())) {
            true => Ok(path),
            false => Err(format!("the name must end in .{}", endings.join(" or ."))),
        }
    })
}

fn parse_colour_bits(text: &str) -> Result<ColourDepth, String> {
    let depth = text.parse().ok().and_then(ColourDepth::from_bits);
    depth.ok_or_else(|| "must be 0, 8, 16 or 24".to_string())
}

/// How to look at the sculpture and what picture to make.
#[derive(Args, Debug, Clone)]
pub struct PictureArgs {
    /// Picture size in pixels
    #[arg(long, default_value = "640x480", value_name = "WxH", value_parser = parse_size)]
    pub size: glam::UVec2,
    /// How to render (default: render.mode in the settings)
    #[arg(long, value_enum)]
    pub mode: Option<RenderMode>,
    /// Draw the cubes of near voxels instead of the smooth surface between them
    #[arg(long)]
    pub voxels: bool,
    /// 3/4, front, back, left, right, top, bottom, or a direction X,Y,Z from the centre to the eye
    #[arg(long, default_value = "3/4", value_name = "VIEW", value_parser = parse_direction, allow_hyphen_values = true)]
    pub camera: Vec3,
    /// The axis of the grid that points up in the picture: x, y, z, -x, -y or -z
    #[arg(long, default_value = "y", value_name = "AXIS", value_parser = parse_axis, allow_hyphen_values = true)]
    pub up: Vec3,
    /// Turn the sculpture about the up axis, in degrees
    #[arg(long, default_value_t = 0.0, value_name = "DEG", allow_hyphen_values = true)]
    pub turn: f32,
    /// Zoom factor; 1 fits the whole sculpture
    #[arg(long, default_value_t = 1.0, value_name = "FACTOR", value_parser = parse_zoom)]
    pub zoom: f32,
    /// Keep parallel lines parallel, without perspective
    #[arg(long)]
    pub orthographic: bool,
    /// Stereo layout (default: stereo.layout in the settings); `layers` writes two pictures
    #[arg(long, value_parser = choices::layouts())]
    pub stereo: Option<StereoLayout>,
    /// Ground below the sculpture, which catches its shadow: a colour #rrggbb, `on` for #c8c6c2, or none (default: none;
    /// in final pictures on). Its lines are a round number of voxels apart, which is printed; final pictures have no lines
    #[arg(long, value_name = "COLOUR", value_parser = parse_ground)]
    pub ground: Option<GroundChoice>,
    /// Antialiasing: average this many pictures, each shifted by a fraction of a pixel, 1 to 64 (default: 1)
    #[arg(long, value_name = "N",
          value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_FINAL_SAMPLES)))]
    pub samples: Option<u32>,
}

/// The value of `--ground`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum GroundChoice {
    None,
    Colour(Rgb),
}

impl GroundChoice {
    /// Returns the colour of the ground, if there is one.
    pub fn colour(self) -> Option<Rgb> {
        match self {
            GroundChoice::None => None,
            GroundChoice::Colour(colour) => Some(colour),
        }
    }
}

fn parse_ground(text: &str) -> Result<GroundChoice, String> {
    match text {
        "none" => Ok(GroundChoice::None),
        "on" => Ok(GroundChoice::Colour(GROUND_COLOUR)),
        _ => {
            let colour = text.parse().map(GroundChoice::Colour);
            colour.map_err(|error: String| format!("{error}, on, or none"))
        }
    }
}

impl PictureArgs {
    pub fn request(&self) -> Result<PictureRequest, ArgumentError> {
        let samples = self.samples.unwrap_or(1);
        if samples > MAX_SAMPLES {
            return Err(ArgumentError::Samples(samples));
        }
        Ok(PictureRequest {
            size: self.size,
            mode: self.mode,
            voxels: self.voxels,
            camera: self.camera,
            up: self.up,
            turn_deg: self.turn,
            zoom: self.zoom,
            orthographic: self.orthographic,
            stereo: self.stereo,
            ground: self.ground.and_then(GroundChoice::colour),
            samples,
        })
    }
}

pub(super) fn parse_size(text: &str) -> Result<glam::UVec2, String> {
    let size = text
        .split_once(['x', 'X'])
        .and_then(|(w, h)| Some(glam::UVec2::new(w.trim().parse().ok()?, h.trim().parse().ok()?)));
    match size {
        Some(s) if s.min_element() >= 1 && s.max_element() <= 16384 => Ok(s),
        _ => Err("write it as WIDTHxHEIGHT, each 1 to 16384".to_string()),
    }
}

fn parse_direction(text: &str) -> Result<Vec3, String> {
    Ok(match text {
        "3/4" => PictureRequest::THREE_QUARTER,
        "front" => Vec3::Z,
        "back" => Vec3::NEG_Z,
        "left" => Vec3::NEG_X,
        "right" => Vec3::X,
        "top" => Vec3::Y,
        "bottom" => Vec3::NEG_Y,
        _ => {
            let parts: Vec<f32> = text.split(',').filter_map(|p| p.trim().parse().ok()).collect();
            let direction = <[f32; 3]>::try_from(parts).map(Vec3::from);
            match direction {
                Ok(d) if d.is_finite() && d.length_squared() > 1e-12 => d,
                _ => {
                    return Err("use 3/4, front, back, left, right, top, bottom, \
                                or three numbers X,Y,Z that are not all zero"
                        .to_string());
                }
            }
        }
    })
}

fn parse_axis(text: &str) -> Result<Vec3, String> {
    let (sign, name) = text.strip_prefix('-').map_or((1.0, text), |name| (-1.0, name));
    let axis = match name {
        "x" => Vec3::X,
        "y" => Vec3::Y,
        "z" => Vec3::Z,
        _ => return Err("must be x, y, z, -x, -y or -z".to_string()),
    };
    Ok(sign * axis)
}

fn parse_zoom(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(zoom) if (0.01..=1000.0).contains(&zoom) => Ok(zoom),
        _ => Err("must be 0.01 to 1000".to_string()),
    }
}

pub(super) fn parse_marker_mm(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(size) if (5.0..=5000.0).contains(&size) => Ok(size),
        _ => Err("must be 5 to 5000".to_string()),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Arguments {
        #[command(flatten)]
        picture: PictureArgs,
    }

    #[test]
    fn the_default_arguments_are_the_default_request() {
        let arguments = Arguments::parse_from(["program"]);
        assert_eq!(arguments.picture.request().unwrap(), PictureRequest::default());
    }
}

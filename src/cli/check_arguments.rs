//! The arguments of `check`.

use clap::Args;
use glam::Vec3;

use crate::print_check::CheckOptions;

/// The requirements of a print.
#[derive(Args, Debug, Clone)]
pub struct CheckArgs {
    /// Thickness that all walls must have, in millimetres
    #[arg(long, default_value_t = CheckOptions::default().wall_mm, value_name = "MM", value_parser = parse_length)]
    pub wall_mm: f32,
    /// Largest angle at which surfaces need no support, in degrees from the vertical: 0 to 90
    #[arg(long, default_value_t = CheckOptions::default().overhang_deg, value_name = "DEG", value_parser = parse_angle)]
    pub overhang_deg: f32,
    /// Length of gaps that are bridged without support, in millimetres
    #[arg(long, default_value_t = CheckOptions::default().bridge_mm, value_name = "MM", value_parser = parse_gap)]
    pub bridge_mm: f32,
    /// Build volume of the printer in millimetres: width x depth x height
    #[arg(long, default_value = "220x220x250", value_name = "WxDxH", value_parser = parse_bed)]
    pub bed: Vec3,
    /// Length of a voxel in millimetres (default: the sculpture's voxel size)
    #[arg(long, alias = "millimeters", value_name = "MM", value_parser = parse_length)]
    pub millimetres: Option<f32>,
}

impl CheckArgs {
    pub fn options(&self) -> CheckOptions {
        CheckOptions {
            voxel_mm: self.millimetres,
            wall_mm: self.wall_mm,
            overhang_deg: self.overhang_deg,
            bridge_mm: self.bridge_mm,
            bed_mm: self.bed,
        }
    }
}

fn parse_length(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(mm) if mm.is_finite() && mm > 0.0 => Ok(mm),
        _ => Err("must be a length above 0".to_string()),
    }
}

fn parse_gap(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(mm) if mm.is_finite() && mm >= 0.0 => Ok(mm),
        _ => Err("must be 0 or more".to_string()),
    }
}

fn parse_angle(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(deg) if (0.0..=90.0).contains(&deg) => Ok(deg),
        _ => Err("must be 0 to 90".to_string()),
    }
}

/// Parses width x depth x height, as printers are described, to x, y and z, with y up.
fn parse_bed(text: &str) -> Result<Vec3, String> {
    let lengths: Result<Vec<f32>, String> = text.split(['x', 'X']).map(parse_length).collect();
    match lengths.as_deref() {
        Ok(&[width, depth, height]) => Ok(Vec3::new(width, height, depth)),
        _ => Err("write it as WIDTHxDEPTHxHEIGHT in millimetres, such as 220x220x250".to_string()),
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Arguments {
        #[command(flatten)]
        check: CheckArgs,
    }

    #[test]
    fn the_default_arguments_are_the_default_options() {
        let arguments = Arguments::parse_from(["program"]);
        assert_eq!(arguments.check.options(), CheckOptions::default());
    }

    #[test]
    fn a_bed_has_width_depth_and_height() {
        assert_eq!(parse_bed("200x180.5X170"), Ok(Vec3::new(200.0, 170.0, 180.5)));
        for text in ["", "200", "200x200", "200x200x200x200", "200x-1x200", "200xnanx200"] {
            assert!(parse_bed(text).unwrap_err().contains("220x220x250"), "{text}");
        }
    }
}

//! The text form of export options: the arguments after the path of `save`.

use std::fmt;

use super::arguments::Arguments;
use super::{ParseError, choice, number};
use crate::format::MeshOptions;
use crate::format::options::{ExportForm, ExportOptions};
use crate::mesh::MeshKind;

/// Writes the options that differ from the defaults.
pub fn write(export: &ExportOptions, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let ExportOptions { form, mesh } = *export;
    let MeshOptions { kind, points_only, up, voxel_mm, triangles } = mesh;
    if form != ExportForm::default() {
        write!(f, " form={form}")?;
    }
    if kind != MeshKind::default() {
        write!(f, " mesh={kind}")?;
    }
    if points_only {
        f.write_str(" vertices=alone")?;
    }
    if let Some(up) = up {
        write!(f, " up={up}")?;
    }
    if let Some(voxel_mm) = voxel_mm {
        write!(f, " millimetres={voxel_mm}")?;
    }
    if let Some(triangles) = triangles {
        write!(f, " triangles={triangles}")?;
    }
    Ok(())
}

/// Reads the arguments after the path.
pub fn parse(args: &mut Arguments) -> Result<ExportOptions, ParseError> {
    Ok(ExportOptions {
        form: args.optional("form", str::parse)?.unwrap_or_default(),
        mesh: MeshOptions {
            kind: args.optional("mesh", str::parse)?.unwrap_or_default(),
            points_only: choice(args, "vertices", ["joined", "alone"])?,
            up: args.optional("up", str::parse)?,
            voxel_mm: args.optional("millimetres", number)?,
            triangles: args.optional("triangles", number)?,
        },
    })
}

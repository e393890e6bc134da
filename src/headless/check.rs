//! The job `check`: the faults that keep a file from being printed in 3D, as text or as JSON for
//! programs.

use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};

use super::{Context, JobError};
use crate::command::Command;
use crate::format::options::ImportOptions;
use crate::print_check::{self, CheckOptions, Checked, FaultLocation, Finding};
use crate::terminal;

/// Places of each kind that are printed as text; JSON has more.
const PRINTED: usize = 10;

/// Checks a file and prints the findings. Fails if it cannot be printed unchanged.
pub fn check(
    file: &Path,
    options: &CheckOptions,
    as_json: bool,
    import: &ImportOptions,
    context: &Context,
) -> Result<(), JobError> {
    let session = context.open_session(file, import)?;
    let grid = session.document().grid();
    let budget = context.config.limits().grid_bytes;
    let checked = print_check::check(grid, options, budget, context.progress)?;
    match as_json {
        true => terminal::print_result(value_of(&checked, options))?,
        false => terminal::print_result(text_of(&checked, options))?,
    }
    if checked.is_printable() { Ok(()) } else { Err(JobError::NotPrintable) }
}

fn text_of(checked: &Checked, options: &CheckOptions) -> String {
    let Checked { voxel_mm, size_mm, fits, contact_mm2, findings } = checked;
    if *size_mm == Vec3::ZERO {
        return "size: nothing to print: there are no voxels".to_string();
    }
    let verdict = if *fits { "fits" } else { "does not fit" };
    let bed = options.bed_mm;
    let mut lines = vec![
        format!("size: {} mm, in voxels of {} mm", of(*size_mm), of(*voxel_mm)),
        format!("bed: {verdict} {} mm; {contact_mm2:.1} mm2 stand on it", of(bed)),
    ];
    for finding in findings {
        let Finding { kind, count, voxels, places, repairs, .. } = finding;
        lines.push(format!("{}: {count} ({voxels} voxels)", kind.name()));
        for place in places.iter().take(PRINTED) {
            let FaultLocation { voxels, bounds } = place;
            let size = (bounds.max - bounds.min).as_vec3() * *voxel_mm;
            let at = bounds.min.to_array().map(|v| v.to_string()).join(",");
            lines.push(format!("  at {at}: {} mm, {voxels} voxels", of(size)));
        }
        if *count > PRINTED {
            lines.push(format!("  and {} more", count - PRINTED));
        }
        let fixes = repairs.iter().map(|repair| Command::Repair(*repair).to_string());
        lines.extend(fixes.map(|fix| format!("  fix: {fix}")));
    }
    lines.push(format!("printable: {}", if checked.is_printable() { "yes" } else { "no" }));
    lines.join("\n")
}

/// Formats width, height and depth.
fn of(size: Vec3) -> String {
    size.to_array()
        .map(|mm| format!("{:.2}", mm).trim_end_matches('0').trim_end_matches('.').to_string())
        .join(" x ")
}

fn value_of(checked: &Checked, options: &CheckOptions) -> Value {
    let findings = checked.findings.iter().map(|finding| {
        let places = finding.places.iter().map(|place| {
            let size = (place.bounds.max - place.bounds.min).as_vec3() * checked.voxel_mm;
            json!({
                "voxels": place.voxels,
                "min": place.bounds.min.to_array(),
                "max": place.bounds.max.to_array(),
                "size_mm": size.to_array(),
            })
        });
        let fixes = finding.repairs.iter().map(|repair| Command::Repair(*repair).to_string());
        json!({
            "kind": finding.kind.key(),
            "count": finding.count,
            "voxels": finding.voxels,
            "places": places.collect::<Vec<_>>(),
            "fixes": fixes.collect::<Vec<_>>(),
        })
    });
    json!({
        "printable": checked.is_printable(),
        "voxel_mm": checked.voxel_mm.to_array(),
        "size_mm": checked.size_mm.to_array(),
        "bed_mm": options.bed_mm.to_array(),
        "fits": checked.fits,
        "contact_mm2": checked.contact_mm2,
        "findings": findings.collect::<Vec<_>>(),
    })
}

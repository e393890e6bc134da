//! The contents of a file, as text or as JSON for programs.

use std::path::Path;

use serde_json::{Value, json};

use super::{Context, JobError};
use crate::format::options::ImportOptions;
use crate::format::{self, Info, Texts};
use crate::terminal;

/// Prints the contents of a file, as one line of JSON if requested.
pub fn info(
    file: &Path,
    import: &ImportOptions,
    as_json: bool,
    context: &Context,
) -> Result<(), JobError> {
    let failed = |error| JobError::Info { path: file.to_path_buf(), error };
    let info = format::info_with(file, import, &context.config.limits(), context.progress)
        .map_err(failed)?;
    match as_json {
        true => terminal::print_result(value_of(&info))?,
        false => terminal::print_result(info)?,
    }
    Ok(())
}

/// Returns the facts of the text as JSON. A fact that the file does not state is null.
fn value_of(info: &Info) -> Value {
    let Info { kind, file_bytes, dims, voxel_size, samples, texts, densities, signature, .. } =
        info;
    let named = texts.named().map(|(name, text)| {
        let text = (!text.is_empty()).then(|| Texts::legible(text));
        (name.to_owned(), json!(text))
    });
    json!({
        "format": kind,
        "file_bytes": file_bytes,
        "dims": dims.to_array(),
        "voxel_size": voxel_size.to_array(),
        "samples": samples.map(|samples| samples.to_string()),
        "bytes_per_voxel": samples.map(|samples| samples.bytes()),
        "densities": densities.as_ref().map(|densities| json!({
            "min": densities.histogram.min,
            "max": densities.histogram.max,
            "automatic_threshold": densities.threshold,
        })),
        "sculpture": signature.as_ref().map(|signature| json!({
            "colour_bits": signature.colour_depth.bits(),
            "base": signature.base.to_string(),
        })),
        "orientation": info.orientation,
        "notes": info.notes,
        "texts": Value::Object(named.into_iter().collect()),
    })
}

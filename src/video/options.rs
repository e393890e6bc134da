//! Options of the video behind the sculpture: its source, the fitting of its frames, and the lens.

use std::path::PathBuf;

use serde::{Deserialize, Deserializer, de};

use super::{Address, Fit};

#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VideoOptions {
    /// Whether the video is shown from the start.
    pub on: bool,
    /// Text of an [`Address`]; empty for the first camera of this machine.
    #[serde(deserialize_with = "address")]
    pub source: String,
    pub fit: Fit,
    pub mirror: bool,
    /// File with the intrinsics of the lens; empty if they are unknown.
    pub lens: PathBuf,
}

fn address<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let text = String::deserialize(from)?;
    match text.trim().is_empty() {
        true => Ok(String::new()),
        false => text.parse::<Address>().map(|_| text).map_err(de::Error::custom),
    }
}

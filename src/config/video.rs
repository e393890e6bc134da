//! The settings of the video picture behind the sculpture.

use std::path::PathBuf;

use serde::{Deserialize, Deserializer, de};

use crate::video::{Address, Fit};

#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct VideoSettings {
    /// Whether it is shown from the start.
    pub on: bool,
    /// As [`Address`] takes it; empty is the first camera of this machine.
    #[serde(deserialize_with = "address")]
    pub source: String,
    pub fit: Fit,
    pub mirror: bool,
    /// The file of the lens's intrinsics; empty if it has not been measured.
    pub lens: PathBuf,
}

fn address<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let text = String::deserialize(from)?;
    match text.trim().is_empty() {
        true => Ok(String::new()),
        false => text.parse::<Address>().map(|_| text).map_err(de::Error::custom),
    }
}

//! Options of the view in the window that belong to no render mode.

use serde::Deserialize;

#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ViewOptions {
    /// Parallel lines stay parallel.
    pub orthographic: bool,
}

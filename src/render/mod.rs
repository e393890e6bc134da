//! The passes of a frame, one file each. They own no policy: what to draw comes in as values.

pub mod backdrop;
pub mod composite;
pub mod gui;
pub mod overlay;
pub mod renderer;
pub mod sampler;
pub mod slicing;
pub mod stereo;
pub mod target;
pub mod volume;

pub use backdrop::{Backdrop, VideoView};
pub use composite::{Background, Composite, CompositeEye};
pub use renderer::{Renderer, Shot};
pub use slicing::Slicing;
pub use stereo::{Stereo, StereoSources};
pub use target::{IndexReadback, IndexTarget};
pub use volume::Volume;

/// Eyes that a picture can have.
pub const MAX_EYES: usize = 2;

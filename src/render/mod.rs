//! Rendering: from a document and a frame description to pictures. The passes of a frame have a
//! file each; they have no policy: what to draw comes in as values.

pub mod backdrop;
pub mod background;
pub mod beam;
mod brick_boxes;
pub mod colours;
pub mod composite;
mod dilated_occupancy;
pub mod dilated_occupancy_image;
mod fallback;
mod frame_cache;
mod frame_desc;
pub mod gpu_only;
pub mod gui;
pub mod light;
mod mean;
pub mod mode;
mod normal_stage;
pub mod normals;
pub mod options;
pub mod overlay;
mod overlay_pixels;
pub mod pictures;
pub mod pixel_pass;
pub mod points;
pub mod ray_march;
mod refine;
pub mod renderer;
pub mod sampler;
mod screen_pass;
pub mod shading;
pub mod slicing;
mod specialised;
pub mod stereo;
pub mod stereo_options;
pub mod surface_shade;
pub mod target;
pub mod times;
pub mod volume;
mod warm_up;

pub use backdrop::{Backdrop, Video, VideoView};
pub use background::Background;
pub use beam::Beams;
pub use colours::Colours;
pub use composite::{Composite, CompositeEye};
pub use fallback::{Fallback, FrameReport};
pub use gpu_only::GpuOnly;
pub use light::LightOptions;
pub use mode::{RenderMode, Sampling, Shading};
pub use normals::Normals;
pub use options::{Finish, RenderOptions};
pub use pixel_pass::PixelStage;
pub use points::Points;
pub use ray_march::RayMarch;
pub use renderer::{FrameDesc, Renderer};
pub use shading::Surface;
pub use slicing::Slicing;
pub use stereo::{Stereo, StereoSources};
pub use stereo_options::StereoOptions;
pub use surface_shade::SurfaceShade;
pub use target::{EyeTask, IndexReadback, IndexTarget};
pub use volume::Volume;
pub use warm_up::WarmUp;

/// Largest number of eyes of a picture.
pub const MAX_EYES: usize = 2;

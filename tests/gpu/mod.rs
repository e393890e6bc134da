//! Tests of Vulkan and the render passes, on any device (lavapipe if there is no other), with the validation layers.

mod agreement;
mod backdrop;
mod bounded;
mod colours;
mod composite;
mod coplanar;
mod device;
pub mod fixture;
mod ground;
mod gui;
mod made_surface;
#[cfg(target_os = "linux")]
mod memory;
mod modes;
mod partial;
mod points;
mod ray_march;
mod reference;
mod refine;
mod shading;
mod slicing;
mod smooth;
mod smooth_edges;
mod stereo;
mod subjects;
mod timing;
mod trace;
mod volume;
mod warm_up;

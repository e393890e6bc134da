//! What the Vulkan side does, on whatever device there is (lavapipe where there is no other),
//! under the validation layers.

mod agreement;
mod backdrop;
mod colours;
mod composite;
mod coplanar;
mod device;
pub mod fixture;
mod gui;
#[cfg(target_os = "linux")]
mod memory;
mod modes;
mod partial;
mod points;
mod ray_march;
mod shading;
mod slicing;
mod stereo;
mod subjects;
mod timing;
mod volume;

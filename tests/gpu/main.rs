//! What the Vulkan side does, on whatever device there is (lavapipe where there is no other),
//! under the validation layers.

mod composite;
mod device;
mod fixture;
mod slicing;
mod subjects;
mod volume;

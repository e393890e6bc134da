//! Computations shared by several brushes: the voxels seen under an outline, filters on blocks of bits, distances, and
//! the motion of surfaces and clay. Changes nothing; knows no brush's options.

mod ball;
mod ball_filter;
pub mod distance;
pub mod filter;
pub mod grab;
pub mod level;
pub mod offset;
#[cfg(test)]
mod offset_tests;
pub mod pulled;
pub mod rays;
pub mod stamp;
mod touched;
pub mod visible;
#[cfg(test)]
mod visible_tests;

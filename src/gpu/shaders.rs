//! Owns the compiled shaders: one `NAME_STAGE: &[u32]` of SPIR-V for each file in `shaders/`
//! (see build.rs).

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

// The composite for a target that encodes sRGB itself. A separate shader, because SIMD lanes would compute both
// colours to select one.

//!include "composite.wgsl"
//!include "encoding.wgsl"

fn stored(colour: vec3<f32>) -> vec3<f32> {
    return decoded(colour, true);
}

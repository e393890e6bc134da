// The ground for a target that encodes sRGB itself.

//!include "ground.wgsl"
//!include "encoding.wgsl"

fn stored(colour: vec3<f32>) -> vec3<f32> {
    return decoded(colour, true);
}

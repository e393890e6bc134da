// The composite for a target that encodes sRGB itself. A shader of its own, since vectors of pixels
// would work out both colours to choose one.

//!include "composite.wgsl"
//!include "encoding.wgsl"

fn stored(colour: vec3<f32>) -> vec3<f32> {
    return decoded(colour, true);
}

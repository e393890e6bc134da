// The linear values to write to a target that encodes sRGB itself.

fn decoded(colour: vec3<f32>, linear: bool) -> vec3<f32> {
    let low = colour / 12.92;
    let high = pow((colour + 0.055) / 1.055, vec3<f32>(2.4));
    return select(colour, select(high, low, colour <= vec3<f32>(0.04045)), linear);
}

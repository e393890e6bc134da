// Shades the faces of the tool preview by their angle to the viewer, like a thin shell.
//!include "overlay_solid.wgsl"

@fragment
fn main(corner: Corner) -> @location(0) vec4<f32> {
    let facing = clamp(normalize(corner.normal).z, 0.0, 1.0);
    let shade = 0.55 + 0.45 * facing;
    let rim = 1.0 - facing;
    let opacity = solid.colour.w * (0.75 + 0.6 * rim * rim);
    return vec4<f32>(solid.colour.xyz * shade, min(opacity, 1.0));
}

// What is behind everything: colours from the upper to the lower edge, infinitely far.

//!include "layout.wgsl"

var<immediate> view: CompositeView;

struct Pixel {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn main(@builtin(position) position: vec4<f32>) -> Pixel {
    let down = (position.y - view.upper) * view.scale_y / f32(view.size.y);
    return Pixel(vec4<f32>(mix(view.top, view.bottom, down), 1.0), 0.0);
}

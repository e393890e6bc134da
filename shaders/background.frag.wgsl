// The background: a vertical gradient.

//!include "layout.wgsl"

var<immediate> view: CompositeView;

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let down = (position.y - view.upper) * view.scale_y / f32(view.size.y);
    return vec4<f32>(mix(view.top, view.bottom, down), 1.0);
}

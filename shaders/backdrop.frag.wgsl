// The video frame behind the sculpture, infinitely far away, undistorted where its lens is known: the
// twin of src/video/framing.rs and src/video/intrinsics.rs.

//!include "layout.wgsl"

var<immediate> view: BackdropView;
@group(0) @binding(0) var video: texture_2d<f32>;

struct Pixel {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

// Projects a direction through a lens: Brown-Conrady model with radial and tangential distortion.
fn distort(ray: vec2<f32>) -> vec2<f32> {
    let r2 = dot(ray, ray);
    let k = view.radial;
    let p = view.tangential;
    let radial = 1.0 + r2 * (k.x + r2 * (k.y + r2 * k.z));
    let xy = ray.x * ray.y;
    let tangential = vec2<f32>(
        2.0 * p.x * xy + p.y * (r2 + 2.0 * ray.x * ray.x),
        p.x * (r2 + 2.0 * ray.y * ray.y) + 2.0 * p.y * xy,
    );
    return ray * radial + tangential;
}

fn texel(at: vec2<i32>) -> vec3<f32> {
    let last = vec2<i32>(view.size) - vec2<i32>(1);
    return textureLoad(video, clamp(at, vec2<i32>(0), last), 0).xyz;
}

@fragment
fn main(@builtin(position) position: vec4<f32>) -> Pixel {
    let size = vec2<f32>(view.size);
    // In pixels of the frame; the centre of the first is at 0.
    var at = (position.xy / view.screen * view.scale + view.offset) * size - 0.5;
    let straight = distort((at - view.centre) / view.focal) * view.focal + view.centre;
    // A select and not a branch: no uniform may decide a branch (render/specialised.rs).
    at = select(at, straight, view.lens != 0u);
    if any(at < vec2<f32>(-0.5)) || any(at > size - 0.5) {
        return Pixel(vec4<f32>(view.beyond, 1.0), 0.0);
    }
    let low = floor(at);
    let share = at - low;
    let corner = vec2<i32>(low);
    let upper = mix(texel(corner), texel(corner + vec2<i32>(1, 0)), share.x);
    let lower = mix(texel(corner + vec2<i32>(0, 1)), texel(corner + vec2<i32>(1, 1)), share.x);
    return Pixel(vec4<f32>(mix(upper, lower, share.y), 1.0), 0.0);
}

// The pictures of two eyes on one screen, with the interface over both: the twin of
// core/src/view/stereo_layout.rs.

//!include "layout.wgsl"

var<immediate> view: StereoView;
@group(0) @binding(0) var left: texture_2d<f32>;
@group(0) @binding(1) var right: texture_2d<f32>;
// Premultiplied, of the size of the window.
@group(0) @binding(2) var interface_image: texture_2d<f32>;

// A specialization constant (kind.wgsl).
var<private> arrangement: u32 = 0x5bec0000u;
const LAYERS: u32 = 1u;
const SIDE_BY_SIDE: u32 = 2u;
const TOP_BOTTOM: u32 = 3u;
const ROWS: u32 = 4u;
const COLUMNS: u32 = 5u;
const ANAGLYPH: u32 = 6u;

// The colour that an eye sees at a pixel of the window.
fn seen(eye: u32, at: vec2<u32>) -> vec3<f32> {
    let over = textureLoad(interface_image, at, 0);
    let place = vec2<i32>(at) - view.corner;
    var behind = vec3<f32>(0.0);
    if all(place >= vec2<i32>(0)) && all(place < vec2<i32>(view.size)) {
        // A select and not a branch: no uniform may decide a branch (render/specialised.rs).
        let of_left = textureLoad(left, place, 0).xyz;
        behind = select(textureLoad(right, place, 0).xyz, of_left, eye == 0u);
    }
    return over.xyz + behind * (1.0 - over.w);
}

// The mean of two neighbours along the axis that is squeezed to half.
fn squeezed(eye: u32, first: vec2<u32>, along: vec2<u32>) -> vec3<f32> {
    let last = view.window - vec2<u32>(1u);
    return 0.5 * (seen(eye, min(first, last)) + seen(eye, min(first + along, last)));
}

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = vec2<u32>(position.xy);
    let half_size = view.window / 2u;
    var colour = vec3<f32>(0.0);
    switch arrangement {
        case SIDE_BY_SIDE: {
            let eye = select(0u, 1u, at.x >= half_size.x);
            let x = 2u * (at.x - eye * half_size.x);
            colour = squeezed(eye, vec2<u32>(x, at.y), vec2<u32>(1u, 0u));
        }
        case TOP_BOTTOM: {
            let eye = select(0u, 1u, at.y >= half_size.y);
            let y = 2u * (at.y - eye * half_size.y);
            colour = squeezed(eye, vec2<u32>(at.x, y), vec2<u32>(0u, 1u));
        }
        case ROWS: {
            colour = seen(at.y % 2u, at);
        }
        case COLUMNS: {
            colour = seen(at.x % 2u, at);
        }
        case ANAGLYPH: {
            colour = vec3<f32>(seen(0u, at).x, seen(1u, at).yz);
        }
        case LAYERS: {
            colour = seen(view.eye, at);
        }
        default: {
            colour = seen(0u, at);
        }
    }
    return vec4<f32>(colour, 1.0);
}

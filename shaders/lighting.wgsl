// Blinn-Phong with ambient light from a hemisphere, and tone mapping: the twin of core/src/shade/illumination.rs. Light is added in linear space;
// gamma 2.0 approximates the sRGB curve.

//!include "kind.wgsl"

@group(0) @binding(5) var<uniform> shading: Shading;

// The texels of a matcap: sRGB, red in the lowest byte.
@group(0) @binding(8) var<storage, read> matcap: array<u32>;

// core/src/shade/look.rs
const MATCAP_EDGE: u32 = 128u;
const MATCAP_RADIUS: f32 = 0.98;

// Squarings for the largest exponent, 1024 (core/src/shade/light.rs).
const EXPONENT_BITS: u32 = 11u;

// Lower bound for a squared length. Much smaller numbers are flushed to 0 on devices without denormals, and a
// division by their root is then not a number.
const LEAST_SQUARE: f32 = 1e-30;

fn unit_or(v: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let squared = dot(v, v);
    return select(v / sqrt(max(squared, 1e-12)), other, squared < 1e-12);
}

fn power(base: f32, exponent: u32) -> f32 {
    var product = 1.0;
    var square = base;
    for (var bit = 0u; bit < EXPONENT_BITS; bit++) {
        product = select(product, product * square, ((exponent >> bit) & 1u) != 0u);
        square *= square;
    }
    return product;
}

fn rows_times(rows: array<vec4<f32>, 3>, v: vec4<f32>) -> vec3<f32> {
    return vec3<f32>(dot(rows[0], v), dot(rows[1], v), dot(rows[2], v));
}

fn matcap_texel(at: u32) -> vec3<f32> {
    let colour = unpack4x8unorm(matcap[at]).xyz;
    return colour * colour;
}

// The light of the point of the matcap's ball that is turned to the eye as this surface is.
fn from_matcap(normal: vec3<f32>, to_eye: vec3<f32>) -> vec3<f32> {
    let right = unit_or(vec3<f32>(to_eye.z, 0.0, -to_eye.x), vec3<f32>(1.0, 0.0, 0.0));
    let up = cross(to_eye, right);
    let last = f32(MATCAP_EDGE - 1u);
    let across = vec2<f32>(dot(normal, right), -dot(normal, up));
    let at = clamp(across * (0.5 * MATCAP_RADIUS * last) + 0.5 * last, vec2<f32>(0.0), vec2<f32>(last));
    let corner = min(floor(at), vec2<f32>(last - 1.0));
    let share = at - corner;
    let first = u32(corner.x) + MATCAP_EDGE * u32(corner.y);
    let upper = mix(matcap_texel(first), matcap_texel(first + 1u), share.x);
    let second = first + MATCAP_EDGE;
    let lower = mix(matcap_texel(second), matcap_texel(second + 1u), share.x);
    return mix(upper, lower, share.y);
}

// The light, as sRGB, that the surface at `point` (grid coordinates) sends to the eye. `outwards` is a covector
// in grid coordinates, of any length; `colour` is sRGB; `open` and `sunlit` are factors on the ambient
// light and on the sun's.
fn lit(
    point: vec3<f32>,
    outwards: vec3<f32>,
    colour: vec3<f32>,
    open: f32,
    sunlit: f32,
) -> vec3<f32> {
    let position = rows_times(shading.eye_from_grid, vec4<f32>(point, 1.0));
    let to_eye = -position / sqrt(max(dot(position, position), LEAST_SQUARE));
    let turned = rows_times(shading.normal_from_gradient, vec4<f32>(outwards, 0.0));
    // A visible surface cannot face away from the eye: that component of the normal is removed.
    var normal = unit_or(turned, to_eye);
    normal = unit_or(normal - to_eye * min(dot(normal, to_eye), 0.0), to_eye);
    let albedo = colour * colour;
    if kind_matcap != 0u {
        return sqrt(from_matcap(normal, to_eye) * (albedo * open));
    }
    let cos_eye = dot(normal, to_eye);
    let upwards = dot(normal, shading.up);
    var sum = albedo * ((shading.ambient_slope * upwards + shading.ambient) * open);
    for (var i = 0u; i < kind_lights; i++) {
        let source = shading.sources[i];
        let way = source.xyz - position;
        let from_place = way / sqrt(max(dot(way, way), LEAST_SQUARE));
        let to_light = select(source.xyz, from_place, source.w != 0.0);
        let cos_light = dot(normal, to_light);
        let between = sqrt(max(2.0 * dot(to_light, to_eye) + 2.0, LEAST_SQUARE));
        let cos_half = max((cos_light + cos_eye) / between, 0.0);
        let highlight = power(cos_half, shading.shininess) * shading.specular;
        let reflected = albedo * max(cos_light, 0.0) + select(0.0, highlight, cos_light > 0.0);
        let share = select(1.0, sunlit, i == shading.sun_light);
        sum += reflected * (share * shading.radiances[i].xyz);
    }
    // core/src/shade/tone.rs
    let tone = shading.tone;
    let mapped =
        sum * (sum * tone.x + tone.y) / (sum * (sum * tone.z + tone.w) + shading.tone_floor);
    return sqrt(clamp(mapped, vec3<f32>(0.0), vec3<f32>(1.0)));
}

// The ground below the sculpture, drawn where nothing is before it: the twin of GroundPicture::pixel
// (core/src/shade/ground/picture.rs).

//!include "layout.wgsl"

var<immediate> view: GroundView;
// The share of the sun's and of the sky's light.
@group(0) @binding(0) var light_map: texture_2d<f32>;

const MAP_EDGE: f32 = 384.0;
const MAJOR: f32 = 5.0;
const MINOR_LINE: vec2<f32> = vec2<f32>(0.5, 0.2);
const MAJOR_LINE: vec2<f32> = vec2<f32>(0.7, 0.4);
const DENSE: f32 = 6.0;

fn grid_lines(cell: vec2<f32>, width: vec2<f32>, line: vec2<f32>) -> f32 {
    let away = abs(cell - floor(cell + 0.5));
    let cover = clamp(line.x + 0.5 - away / width, vec2<f32>(0.0), vec2<f32>(1.0));
    let sparse = clamp(2.0 - width * DENSE, vec2<f32>(0.0), vec2<f32>(1.0));
    let both = cover * sparse;
    return max(both.x, both.y) * line.y;
}

fn shares(place: vec2<f32>) -> vec2<f32> {
    let at = clamp((place * 0.5 + 0.5) * MAP_EDGE - 0.5, vec2<f32>(0.0), vec2<f32>(MAP_EDGE - 1.0));
    let low = min(floor(at), vec2<f32>(MAP_EDGE - 2.0));
    let share = at - low;
    let first = vec2<i32>(low);
    let a = textureLoad(light_map, first, 0).xy;
    let b = textureLoad(light_map, first + vec2<i32>(1, 0), 0).xy;
    let c = textureLoad(light_map, first + vec2<i32>(0, 1), 0).xy;
    let d = textureLoad(light_map, first + vec2<i32>(1, 1), 0).xy;
    return mix(mix(a, b, share.x), mix(c, d, share.x), share.y);
}

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = vec3<f32>(position.xy, 1.0);
    let falls = dot(view.rows[2].xyz, at);
    if falls <= 0.0 {
        discard;
    }
    let place = vec2<f32>(dot(view.rows[0].xyz, at), dot(view.rows[1].xyz, at)) / falls;
    let inside = 1.0 - dot(place, place);
    if inside <= 0.0 {
        discard;
    }
    let fade = inside * inside * (3.0 - 2.0 * inside);
    let arrives = shares(place);
    let ambient = view.light[0].xyz;
    let others = view.light[1].xyz;
    let direct = view.light[2].xyz;
    let light = ambient * arrives.y + others + direct * arrives.x;
    let full = ambient + others + direct;
    let share = dot(light, vec3<f32>(1.0)) / max(dot(full, vec3<f32>(1.0)), 1e-6);
    let falling = view.rows[2].xy;
    let sideways = vec4<f32>(view.rows[0].x, view.rows[1].x, view.rows[0].y, view.rows[1].y);
    let step_x = abs(sideways.xy - place * falling.x) / falls;
    let step_y = abs(sideways.zw - place * falling.y) / falls;
    let cells = view.lines.xy;
    let width = max(max(step_x, step_y) * cells, vec2<f32>(1e-9));
    let cell = place * cells + view.lines.zw;
    let minor = grid_lines(cell, width, MINOR_LINE);
    let ink = max(minor, grid_lines(cell / MAJOR, width / MAJOR, MAJOR_LINE));
    let tone = view.tone;
    let mapped =
        light * (light * tone.x + tone.y) / (light * (light * tone.z + tone.w) + view.light[0].w);
    let colour = sqrt(clamp(mapped, vec3<f32>(0.0), vec3<f32>(1.0))) * (1.0 - ink);
    // Selects and no branches: no uniform may decide a branch (render/specialised.rs).
    let shadow_only = view.rows[1].w != 0.0;
    return vec4<f32>(
        select(stored(colour), vec3<f32>(0.0), shadow_only),
        fade * select(1.0, 1.0 - sqrt(share), shadow_only),
    );
}

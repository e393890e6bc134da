// Smooths the edges of a picture where the depth of the surface leaps: morphological antialiasing (A. Reshetov,
// "Morphological antialiasing", 2009), by depth instead of colour, so that the surface's own colours stay as they are.
//
// A step of an outline is taken for a part of a straight line, from the middle of the step at its one end to that at
// the other. The pixels beside the outline are mixed with those across it by the area that the line cuts off.

//!include "layout.wgsl"

var<immediate> view: EdgesView;
@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var depths: texture_2d<f32>;

// How far the ends of a step are searched, in pixels: src/render/smooth_edges.rs.
const REACH: i32 = 12;

// 1 over the distance from the eye's plane, in units of the near plane; 0 for nothing.
fn nearness(at: vec2<i32>) -> f32 {
    let last = vec2<i32>(view.size) - vec2<i32>(1);
    return textureLoad(depths, clamp(at, vec2<i32>(0), last), 0).x;
}

// The least leap between two surfaces at this nearness.
fn leap(nearness: f32) -> f32 {
    return view.leap * nearness * nearness;
}

struct End {
    // Pixels from the start.
    away: f32,
    // 1 where the nearer surface goes on in the row of the farther one, -1 where it ends; 0 if not found.
    turn: f32,
}

// Follows a step from the pixels `near` and `far` on its sides.
fn end_of_step(near: vec2<i32>, far: vec2<i32>, along: vec2<i32>, middle: f32) -> End {
    for (var i = 1; i <= REACH; i++) {
        let a = nearness(near + along * i);
        let b = nearness(far + along * i);
        if a - b <= leap(max(a, b)) {
            return End(f32(i), select(-1.0, 1.0, b > middle));
        }
    }
    return End(f32(REACH + 1), 0.0);
}

// The part of a pixel in its middle that the lines from both ends of a step cut off on one side: that of the nearer
// surface (side 1) or of the farther (-1).
fn cut_off(left: End, right: End, side: f32) -> f32 {
    let half_length = 0.5 * (left.away + right.away - 1.0);
    let middle = 0.5 * (right.away - left.away);
    let to_left = clamp(vec2<f32>(middle + 0.5, middle - 0.5), vec2<f32>(0.0), vec2<f32>(1e3));
    let to_right = clamp(vec2<f32>(0.5 - middle, -0.5 - middle), vec2<f32>(0.0), vec2<f32>(1e3));
    let on_left = 0.25 * (to_left.x * to_left.x - to_left.y * to_left.y) / half_length;
    let on_right = 0.25 * (to_right.x * to_right.x - to_right.y * to_right.y) / half_length;
    return select(0.0, on_left, left.turn == side) + select(0.0, on_right, right.turn == side);
}

// How much of the pixel at `at` the one at `at + over` takes.
fn share_of(at: vec2<i32>, over: vec2<i32>) -> f32 {
    let here = nearness(at);
    let there = nearness(at + over);
    // What goes on evenly on one of the sides is one surface, seen at a flat angle.
    let slope = min(abs(here - nearness(at - over)), abs(there - nearness(at + over * 2)));
    if abs(here - there) <= leap(max(here, there)) + 2.0 * slope {
        return 0.0;
    }
    let is_near = here > there;
    let near = select(at + over, at, is_near);
    let far = select(at, at + over, is_near);
    let along = vec2<i32>(over.y, over.x);
    let middle = 0.5 * (here + there);
    let left = end_of_step(near, far, -along, middle);
    let right = end_of_step(near, far, along, middle);
    return cut_off(left, right, select(1.0, -1.0, is_near));
}

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = vec2<i32>(position.xy);
    let own = textureLoad(picture, at, 0);
    let here = nearness(at);
    let beside = vec4<f32>(
        nearness(at + vec2<i32>(1, 0)),
        nearness(at + vec2<i32>(-1, 0)),
        nearness(at + vec2<i32>(0, 1)),
        nearness(at + vec2<i32>(0, -1)),
    );
    let nearer = max(beside, vec4<f32>(here));
    let differ = abs(beside - here) > view.leap * nearer * nearer;
    if !any(differ) {
        return own;
    }
    // Of the two neighbours on each axis the one that differs more.
    let leaps = abs(beside - here);
    let over_x = vec2<i32>(select(-1, 1, leaps.x >= leaps.y), 0);
    let over_y = vec2<i32>(0, select(-1, 1, leaps.z >= leaps.w));
    var share = 0.0;
    var chosen = over_x;
    if differ.x || differ.y {
        share = share_of(at, over_x);
    }
    if differ.z || differ.w {
        let found = share_of(at, over_y);
        chosen = select(chosen, over_y, found > share);
        share = max(share, found);
    }
    if share <= 0.0 {
        return own;
    }
    let last = vec2<i32>(view.size) - vec2<i32>(1);
    let other = textureLoad(picture, clamp(at + chosen, vec2<i32>(0), last), 0);
    // Gamma 2, as where surfaces are lit, unless the device has decoded the picture.
    let light = mix(own.xyz * own.xyz, other.xyz * other.xyz, share);
    let mixed = select(sqrt(light), mix(own.xyz, other.xyz, share), view.linear != 0u);
    return vec4<f32>(mixed, mix(own.w, other.w, share));
}

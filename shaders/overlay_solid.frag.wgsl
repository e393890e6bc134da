// Shades the faces of the tool preview by their angle to the viewer, like a thin shell, and compares them with the
// sculpture as if they lay a margin nearer: the surface that a solid has made follows it in steps.
//!include "overlay_solid.wgsl"

struct Pixel {
    @location(0) colour: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

// Of the way to the eye, how much is taken at most.
const MOST_SHARE: f32 = 0.9;

// One over half the edges of the box about the solid, in eye space.
fn over_halves() -> vec3<f32> {
    let rows = solid.eye_from_normal;
    let x = length(vec3<f32>(rows[0].x, rows[1].x, rows[2].x));
    let y = length(vec3<f32>(rows[0].y, rows[1].y, rows[2].y));
    let z = length(vec3<f32>(rows[0].z, rows[1].z, rows[2].z));
    return vec3<f32>(x, y, z);
}

// How much of the way from a place to the eye is within that box, if it is larger by the margin; of solids that are
// round about an axis, within the cylinder in it.
fn to_box(place: vec3<f32>, over_halves: vec3<f32>) -> f32 {
    let way = solid.eye - place;
    let sides = 1.0 + solid.margin * over_halves;
    let exits = (sides - place * sign(way)) / max(abs(way), vec3<f32>(1e-30));
    let exit = min(exits.x, min(exits.y, exits.z));
    let start = place.xz / sides.xz;
    let across = way.xz / sides.xz;
    let long = max(length(across), 1e-30);
    let along = dot(start, across) / long;
    let round_exit = (sqrt(max(along * along + 1.0 - dot(start, start), 0.0)) - along) / long;
    return select(exit, min(exit, round_exit), solid.straight > 0.0);
}

// How much of the curvature there is on the way to the eye. Along its axis a cylinder is straight.
fn curved(corner: Corner, over_halves: vec3<f32>) -> f32 {
    let way = normalize((solid.eye - corner.place) / over_halves);
    return mix(1.0, corner.side * (1.0 - way.y * way.y), solid.straight);
}

@fragment
fn main(corner: Corner) -> Pixel {
    let long = length(corner.normal);
    let facing = clamp(corner.normal.z / long, 0.0, 1.0);
    let shade = 0.55 + 0.45 * facing;
    let rim = 1.0 - facing;
    let colour = unpack4x8unorm(solid.colour);
    let opacity = colour.w * (0.75 + 0.6 * rim * rim);
    // To a ball about the centre of curvature, larger by the margin.
    let depth = corner.position.z;
    let height = max(corner.height / long, 0.0);
    let over_halves = over_halves();
    let bend = solid.bend * curved(corner, over_halves) / (depth * depth);
    let to_ball = 2.0 * solid.margin / max(height + sqrt(height * height + bend), 1e-30);
    let to_margin = min(to_ball, to_box(corner.place, over_halves));
    let share = min(to_margin, min(solid.most * depth, MOST_SHARE));
    let colour_shaded = vec4<f32>(colour.xyz * shade, min(opacity, 1.0));
    return Pixel(colour_shaded, min(depth / (1.0 - share), 1.0));
}

// Structures shared by CPU and shaders: the twin of src/gpu/layout.rs, which documents the members. A test
// compares the two.

struct SliceView {
    origin: vec3<f32>,
    axis: u32,
    corner: vec3<f32>,
    depth_step: f32,
    step_x: vec3<f32>,
    margin_px: f32,
    step_y: vec3<f32>,
    small_least: i32,
    clip_x: vec3<f32>,
    small_x: i32,
    clip_y: vec3<f32>,
    small_y: i32,
    clip_w: vec3<f32>,
    small_z: i32,
    dims: vec3<u32>,
}

const NO_VOXEL: u32 = 0xffffffffu;

struct CompositeView {
    origin: vec3<f32>,
    depth_slope: f32,
    corner: vec3<f32>,
    depth_at_0: f32,
    step_x: vec3<f32>,
    scale_x: f32,
    step_y: vec3<f32>,
    scale_y: f32,
    dims: vec3<u32>,
    tile_log2: u32,
    top: vec3<f32>,
    left: f32,
    bottom: vec3<f32>,
    upper: f32,
    size: vec2<u32>,
    linear: u32,
}

struct MarchView {
    origin: vec3<f32>,
    width: u32,
    corner: vec3<f32>,
    height: u32,
    step_x: vec3<f32>,
    tile_log2: u32,
    step_y: vec3<f32>,
    sample: u32,
    dims: vec3<u32>,
    small_least: i32,
    small_weights: vec3<i32>,
}

struct Shading {
    eye_from_grid: array<vec4<f32>, 3>,
    normal_from_gradient: array<vec4<f32>, 3>,
    sources: array<vec4<f32>, 4>,
    radiances: array<vec4<f32>, 4>,
    ambient: vec3<f32>,
    specular: f32,
    base: vec3<f32>,
    shininess: u32,
    dims: vec3<u32>,
    tone_floor: f32,
    bricks: vec3<u32>,
    small_least: i32,
    ambient_slope: vec3<f32>,
    sun_light: u32,
    up: vec3<f32>,
    sun_sample: u32,
    tone: vec4<f32>,
    sun_towards: vec3<f32>,
    small_x: i32,
    sun_right: vec3<f32>,
    small_y: i32,
    sun_up: vec3<f32>,
    small_z: i32,
}

struct StereoView {
    window: vec2<u32>,
    size: vec2<u32>,
    corner: vec2<i32>,
    eye: u32,
}

struct MeanView {
    weight: f32,
    linear: u32,
}

struct EdgesView {
    size: vec2<u32>,
    leap: f32,
    linear: u32,
}

struct GroundView {
    rows: array<vec4<f32>, 3>,
    light: array<vec4<f32>, 3>,
    tone: vec4<f32>,
    lines: vec4<f32>,
}

struct BackdropView {
    scale: vec2<f32>,
    offset: vec2<f32>,
    focal: vec2<f32>,
    centre: vec2<f32>,
    radial: vec3<f32>,
    lens: u32,
    beyond: vec3<f32>,
    tangential: vec2<f32>,
    screen: vec2<f32>,
    size: vec2<u32>,
}

struct PointView {
    origin: vec3<f32>,
    depth_slope: f32,
    corner: vec3<f32>,
    depth_at_0: f32,
    step_x: vec3<f32>,
    left: f32,
    step_y: vec3<f32>,
    upper: f32,
    clip_x: vec3<f32>,
    linear: u32,
    clip_y: vec3<f32>,
    margin_x: f32,
    clip_w: vec3<f32>,
    margin_y: f32,
}

struct TraceScene {
    world_from_grid: array<vec4<f32>, 3>,
    grid_from_world: array<vec4<f32>, 3>,
    world_from_normal: array<vec4<f32>, 3>,
    up: vec3<f32>,
    radius: f32,
    low: vec3<f32>,
    ground_offset: f32,
    high: vec3<f32>,
    sun_sine: f32,
    middle: vec3<f32>,
    lamp_area: f32,
    ground_height: vec3<f32>,
    focus: f32,
    ground_albedo: vec3<f32>,
    open_ground: vec3<f32>,
    towards_sun: vec3<f32>,
    sun_irradiance: vec3<f32>,
    sun_radiance: vec3<f32>,
    zenith: vec3<f32>,
    horizon: vec3<f32>,
    glow: vec3<f32>,
    below: vec3<f32>,
    lamp_centre: vec3<f32>,
    lamp_u: vec3<f32>,
    lamp_v: vec3<f32>,
    lamp_normal: vec3<f32>,
    lamp_radiance: vec3<f32>,
    pupil_right: vec3<f32>,
    pupil_up: vec3<f32>,
    base: vec3<f32>,
    dims: vec3<u32>,
    bricks: vec3<u32>,
}

struct TraceRays {
    origin: vec3<f32>,
    index: u32,
    corner: vec3<f32>,
    width: u32,
    step_x: vec3<f32>,
    height: u32,
    step_y: vec3<f32>,
    first_row: u32,
}

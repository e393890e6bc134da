// A pass of a final picture: adds a sample to each pixel of some rows. The twin of core/src/trace: path.rs,
// environment.rs and mod.rs.

//!include "trace_scene.wgsl"
//!include "trace_sampling.wgsl"
//!include "square.wgsl"

var<immediate> rays: TraceRays;
// PixelSum of core/src/trace/film.rs.
@group(0) @binding(1) var<storage, read_write> film: array<f32>;

const PIXEL_NUMBERS: u32 = 14u;
const FRAC_1_PI: f32 = 0.318309886;
const ROULETTE_FROM: u32 = 1u;
const HALF_FADED_RADII: f32 = 12.0;
const LEAST_ALBEDO: f32 = 0.01;

fn sky(direction: vec3<f32>) -> vec3<f32> {
    let height = dot(direction, scene.up);
    if height < 0.0 {
        return scene.below;
    }
    let low = (1.0 - height) * (1.0 - height);
    let near_sun = max(dot(direction, scene.towards_sun), 0.0);
    let c2 = near_sun * near_sun;
    let c8 = (c2 * c2) * (c2 * c2);
    let c32 = (c8 * c8) * (c8 * c8);
    return scene.zenith + (scene.horizon - scene.zenith) * (low * low)
        + scene.glow * (0.25 * c8 + 0.75 * c32);
}

fn horizon_at(direction: vec3<f32>) -> vec3<f32> {
    let level = direction - scene.up * dot(direction, scene.up);
    if dot(level, level) == 0.0 {
        return sky(scene.up);
    }
    return sky(normalize(level));
}

fn background(direction: vec3<f32>) -> vec3<f32> {
    var light = sky(direction);
    if trace_sun != 0u {
        let off = cross(direction, scene.towards_sun);
        let inside = dot(off, off) < scene.sun_sine * scene.sun_sine;
        if inside && dot(direction, scene.towards_sun) > 0.0 {
            light += scene.sun_radiance;
        }
    }
    return light;
}

// The irradiance of sun and lamp.
fn direct(at: Met) -> vec3<f32> {
    var irradiance = vec3<f32>(0.0);
    if trace_sun != 0u {
        let direction = above_disc(scene.towards_sun, disc_point(next_2d()) * scene.sun_sine);
        let cosine = dot(direction, at.normal);
        if cosine > 0.0 && !is_blocked(at.start, direction, 3e38) {
            irradiance += scene.sun_irradiance * cosine;
        }
    }
    if trace_lamp != 0u {
        let place = next_2d() * 2.0 - 1.0;
        let to_lamp = scene.lamp_centre + scene.lamp_u * place.x + scene.lamp_v * place.y
            - world_point(at.start);
        let squared = dot(to_lamp, to_lamp);
        let cosine = dot(to_lamp, at.normal);
        let facing = -dot(to_lamp, scene.lamp_normal);
        if cosine > 0.0 && facing > 0.0 && !is_blocked(at.start, to_lamp, 1.0) {
            irradiance += scene.lamp_radiance * (scene.lamp_area * cosine * facing / (squared * squared));
        }
    }
    return irradiance;
}

// What a surface sends to the eye.
fn radiance_of(seen: Met) -> vec3<f32> {
    var at = seen;
    var radiance = vec3<f32>(0.0);
    var throughput = seen.albedo;
    var bounce = 0u;
    loop {
        radiance += throughput * (FRAC_1_PI * direct(at));
        let direction = above_disc(at.normal, disc_point(next_2d()));
        let next = meet(at.start, direction);
        if next.what == NOTHING {
            return radiance + throughput * sky(direction);
        }
        if next.what == OPEN_GROUND {
            return radiance + throughput * scene.open_ground;
        }
        if bounce >= trace_bounces {
            break;
        }
        at = next;
        throughput *= next.albedo;
        if bounce >= ROULETTE_FROM {
            let survival = min(max(throughput.x, max(throughput.y, throughput.z)), 1.0);
            if next_1d() >= survival {
                break;
            }
            throughput /= survival;
        }
        bounce += 1u;
    }
    return radiance;
}

// Where a ray meets the lit side of the lamp.
fn lamp_on(origin: vec3<f32>, step: vec3<f32>) -> f32 {
    let facing = dot(step, scene.lamp_normal);
    if facing >= 0.0 {
        return 3e38;
    }
    let t = dot(scene.lamp_centre - origin, scene.lamp_normal) / facing;
    let from_centre = origin + step * t - scene.lamp_centre;
    let inside = abs(dot(from_centre, scene.lamp_u)) <= dot(scene.lamp_u, scene.lamp_u)
        && abs(dot(from_centre, scene.lamp_v)) <= dot(scene.lamp_v, scene.lamp_v);
    return select(3e38, t, t > 0.0 && inside);
}

// The first sample does not find anything.
fn add_number(place: u32, number: f32) {
    film[place] = select(film[place], 0.0, rays.index == 0u) + number;
}

fn add(pixel: u32, light: vec3<f32>, at: Met) {
    let first = pixel * PIXEL_NUMBERS;
    let surface = select(0.0, 1.0, at.what != NOTHING);
    let depth = select(0.0, at.t, at.what != NOTHING);
    let divided = light / max(at.albedo + (1.0 - surface), vec3<f32>(LEAST_ALBEDO));
    let brightness = dot(divided, vec3<f32>(0.2126, 0.7152, 0.0722));
    for (var i = 0u; i < 3u; i++) {
        add_number(first + i, light[i]);
        add_number(first + 3u + i, at.albedo[i]);
        add_number(first + 6u + i, at.normal[i]);
    }
    add_number(first + 9u, depth);
    add_number(first + 10u, surface);
    add_number(first + 11u, select(0.0, 1.0, at.what == SCULPTURE));
    add_number(first + 12u, brightness);
    add_number(first + 13u, brightness * brightness);
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let at = pixel_of(group, lane) + vec2<u32>(0u, rays.first_row);
    if any(at >= vec2<u32>(rays.width, rays.height)) {
        return;
    }
    let pixel = at.x + at.y * rays.width;
    begin_sampling(pixel, rays.index);
    var origin = rays.origin;
    let place = vec2<f32>(at) + 0.5;
    var along = rays.corner + rays.step_x * place.x + rays.step_y * place.y;
    if trace_pupil != 0u {
        let disc = disc_point(next_2d());
        let offset = scene.pupil_right * disc.x + scene.pupil_up * disc.y;
        origin += offset;
        along -= offset / scene.focus;
    }
    let met = met_by_eye(origin, along);
    let step = rows_times(scene.world_from_grid, along);
    let direction = normalize(step);
    if trace_lamp != 0u {
        if lamp_on(world_point(origin), step) < met.t {
            add(pixel, scene.lamp_radiance, MISSED);
            return;
        }
    }
    if met.what == NOTHING {
        add(pixel, background(direction), MISSED);
        return;
    }
    var light = radiance_of(met);
    if met.what == GROUND {
        let away = distance_radii(origin + along * met.t) / HALF_FADED_RADII;
        let fade = away * away / (1.0 + away * away);
        light = mix(light, horizon_at(direction), fade);
    }
    add(pixel, light, met);
}

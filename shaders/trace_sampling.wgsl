// Random numbers of a final picture: the twin of core/src/trace/sampling.rs, bit for bit.

var<private> reversed_index: u32;
var<private> decision: u32;

fn hash(value: u32) -> u32 {
    var x = (value ^ (value >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

fn scramble(value: u32, seed: u32) -> u32 {
    var x = value ^ (value * 0x3d20adeau);
    x = x + seed;
    x = x * ((seed >> 16u) | 1u);
    x = x ^ (x * 0x05526c56u);
    return x ^ (x * 0x53a22864u);
}

fn second_dimension(value: u32) -> u32 {
    var x = value ^ ((value << 1u) & 0xaaaaaaaau);
    x = x ^ ((x << 2u) & 0xccccccccu);
    x = x ^ ((x << 4u) & 0xf0f0f0f0u);
    x = x ^ ((x << 8u) & 0xff00ff00u);
    return x ^ (x << 16u);
}

fn rotated(x: u32, by: u32) -> u32 {
    return (x << by) | (x >> (32u - by));
}

fn unit(x: u32) -> f32 {
    return f32(x >> 8u) * (1.0 / 16777216.0);
}

fn begin_sampling(pixel: u32, index: u32) {
    reversed_index = reverseBits(index);
    decision = hash(pixel);
}

fn next_2d() -> vec2<f32> {
    decision = decision + 0x9e3779b9u;
    let seed = hash(decision);
    let first = scramble(reversed_index, seed);
    let second = second_dimension(first);
    let x = reverseBits(scramble(reverseBits(first), rotated(seed, 11u) ^ 0x68bc21ebu));
    let y = reverseBits(scramble(reverseBits(second), rotated(seed, 21u) ^ 0x02e5be93u));
    return vec2<f32>(unit(x), unit(y));
}

fn next_1d() -> f32 {
    decision = decision + 0x9e3779b9u;
    let seed = hash(decision);
    let first = scramble(reversed_index, seed);
    return unit(reverseBits(scramble(reverseBits(first), rotated(seed, 11u) ^ 0x68bc21ebu)));
}

const QUARTER_PI: f32 = 0.785398163;

// A point of the unit disc from one of the unit square.
fn disc_point(at: vec2<f32>) -> vec2<f32> {
    let p = at * 2.0 - 1.0;
    if all(p == vec2<f32>(0.0)) {
        return p;
    }
    let wide = abs(p.x) > abs(p.y);
    let radius = select(p.y, p.x, wide);
    let part = select(p.x, p.y, wide) / radius;
    let angle = select(2.0 * QUARTER_PI - QUARTER_PI * part, QUARTER_PI * part, wide);
    return vec2<f32>(cos(angle), sin(angle)) * radius;
}

// A direction at a point of the disc around `axis`, seen along it.
fn above_disc(axis: vec3<f32>, disc: vec2<f32>) -> vec3<f32> {
    let side = select(-1.0, 1.0, axis.z >= 0.0);
    let a = -1.0 / (side + axis.z);
    let b = axis.x * axis.y * a;
    let u = vec3<f32>(1.0 + side * axis.x * axis.x * a, side * b, -side * axis.x);
    let v = vec3<f32>(b, side + axis.y * axis.y * a, -axis.y);
    return u * disc.x + v * disc.y + axis * sqrt(max(1.0 - dot(disc, disc), 0.0));
}

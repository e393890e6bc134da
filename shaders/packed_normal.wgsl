// Unit vectors in 16 bits: the twin of core/src/shade/normal_field/packed.rs.

// Of a voxel without a normal.
const NO_NORMAL: u32 = 0xffffu;

// Between 0.57 and 1 long.
fn unpacked_normal(code: u32) -> vec3<f32> {
    let flat = vec2<f32>(f32(code & 255u), f32((code >> 8u) & 255u)) * (1.0 / 127.0) - 1.0;
    let size = abs(flat);
    let z = 1.0 - size.x - size.y;
    let folded = select(1.0 - size.yx, size.yx - 1.0, flat < vec2<f32>(0.0));
    return vec3<f32>(select(flat, folded, z < 0.0), z);
}

// The code of a vector of any length; that of no normal for 0.
fn code_of_normal(v: vec3<f32>) -> u32 {
    let size = abs(v.x) + abs(v.y) + abs(v.z);
    if !(size > 0.0) {
        return NO_NORMAL;
    }
    let flat = v.xy / size;
    let other = 1.0 - abs(flat.yx);
    let folded = select(other, -other, flat < vec2<f32>(0.0));
    let steps = vec2<u32>(select(flat, folded, v.z < 0.0) * 127.0 + 127.5);
    return steps.x | (steps.y << 8u);
}

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

// From the index of a voxel in an index map to its coordinates.

// Quotient and remainder without integer division, which is slow on SIMD: an estimate in f32, off by at most
// one if the quotient is below 2^22 and the divisor below 2^30.
fn divide(number: u32, by: i32) -> vec2<i32> {
    let quotient = i32(f32(number) * (1.0 / f32(by)));
    let rest = i32(number - u32(quotient) * u32(by));
    // -1 below 0, 1 at or above the divisor.
    let off = (rest >> 31u) - ((by - 1 - rest) >> 31u);
    return vec2<i32>(quotient + off, rest - off * by);
}

// The voxel `x + y*dX + z*dX*dY`. No axis is longer than 4096.
fn voxel_of(index: u32, dims: vec3<u32>) -> vec3<i32> {
    let size = vec3<i32>(dims);
    let layer = divide(index, size.x * size.y);
    let row = divide(u32(layer.y), size.x);
    return vec3<i32>(row.y, row.x, layer.x);
}

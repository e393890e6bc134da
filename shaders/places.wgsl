// Voxels by their number in an index map.

// Quotient and remainder, for numbers of any size, without the integer division that is slow on
// SIMD: an estimate in f32 is off by at most a few units, which a second one makes good.
fn divide(number: u32, by: u32) -> vec2<u32> {
    let inverse = 1.0 / f32(by);
    var quotient = u32(f32(number) * inverse);
    var rest = i32(number - quotient * by);
    let correction = i32(floor(f32(rest) * inverse));
    quotient += u32(correction);
    rest -= correction * i32(by);
    if rest < 0 {
        quotient -= 1u;
        rest += i32(by);
    }
    if rest >= i32(by) {
        quotient += 1u;
        rest -= i32(by);
    }
    return vec2<u32>(quotient, u32(rest));
}

// The voxel `x + y*dX + z*dX*dY`.
fn voxel_of(index: u32, dims: vec3<u32>) -> vec3<i32> {
    let yz = divide(index, dims.x);
    let z = divide(yz.x, dims.y);
    return vec3<i32>(i32(yz.y), i32(z.y), i32(z.x));
}

// The pixels of a workgroup of 64 invocations: a square of 8x8.

// Neighbouring invocations have neighbouring pixels: eight of them cover 4x2, thirty-two 8x4.
fn pixel_of(group: vec3<u32>, lane: u32) -> vec2<u32> {
    let x = (lane & 3u) | ((lane >> 1u) & 4u);
    let y = ((lane >> 2u) & 1u) | ((lane >> 3u) & 6u);
    return group.xy * 8u + vec2<u32>(x, y);
}

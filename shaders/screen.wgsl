// One triangle that covers the whole target; draw 3 vertices.

// Clip position of vertex 0, 1 or 2, at depth 0 (infinitely far).
fn screen_triangle(vertex: u32) -> vec4<f32> {
    let x = f32((vertex << 1u) & 2u);
    let y = f32(vertex & 2u);
    return vec4<f32>(2.0 * x - 1.0, 2.0 * y - 1.0, 0.0, 1.0);
}

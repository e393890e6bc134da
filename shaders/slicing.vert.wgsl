// A rectangle of voxels in one layer becomes the rectangle on the layer's centre plane through which every ray
// passes that meets the layer within that rectangle. Seen from the eye, its outlines on the nearer and farther
// plane are scaled about the eye's foot point, so the larger of each is used.

//!include "layout.wgsl"

var<immediate> view: SliceView;

// Enlargement of the outline in voxels, to allow for rounding. The pixels that it adds are discarded.
const MARGIN_VX: f32 = 0.02;
// The same for each voxel of the distance from the eye, for eyes that are far away.
const MARGIN_PER_VX: f32 = 4e-7;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) planes: vec2<u32>,
}

// How far an edge `along` an axis of the layer, through the point `from_eye`, has to move perpendicular to itself
// within the layer's plane to move by one pixel in the picture. This is proportional to the depth w along the
// edge, so the values at the corners interpolate correctly; behind the eye any value will do.
fn voxels_per_pixel(from_eye: vec3<f32>, along: vec3<f32>, across_layer: u32) -> f32 {
    // The normal of the plane through the eye and the edge.
    let normal = cross(along, from_eye);
    let pixel = vec2<f32>(dot(view.step_x, normal), dot(view.step_y, normal));
    return length(pixel) * abs(dot(view.clip_w, from_eye) / from_eye[across_layer]);
}

// rect: lower and upper u, lower and upper v. layer: lower and upper plane, rank, and whether it covers the
// picture. In voxels; u and v are the axes after the layer's axis in the cycle x, y, z.
@vertex
fn main(
    @builtin(vertex_index) vertex: u32,
    @location(0) rect: vec4<u32>,
    @location(1) layer: vec4<u32>,
) -> Corner {
    let upper = vec2<bool>((vertex & 1u) != 0u, (vertex & 2u) != 0u);
    // Ranks serve as depths: exact, and constant within a layer.
    let depth = 1.0 - f32(layer.z + 1u) * view.depth_step;
    if layer.w != 0u {
        let corner = select(vec2<f32>(-1.0), vec2<f32>(1.0), upper);
        return Corner(vec4<f32>(corner, depth, 1.0), layer.xy);
    }
    let d = view.axis;
    let u = (view.axis + 1u) % 3u;
    let v = (view.axis + 2u) % 3u;
    let eye = vec2<f32>(view.origin[u], view.origin[v]);
    let planes = vec2<f32>(layer.xy);
    let middle = 0.5 * (planes.x + planes.y);
    let scale = (middle - view.origin[d]) / (planes - view.origin[d]);
    let outline = vec2<f32>(select(rect.xz, rect.yw, upper));
    let near = eye + (outline - eye) * scale.x;
    let far = eye + (outline - eye) * scale.y;
    let rounding = MARGIN_VX + MARGIN_PER_VX * abs(middle - view.origin[d]);
    let seen = select(min(near, far) - rounding, max(near, far) + rounding, upper);
    var from_eye = vec3<f32>(0.0);
    from_eye[d] = middle - view.origin[d];
    from_eye[u] = seen.x - eye.x;
    from_eye[v] = seen.y - eye.y;
    // The rasteriser snaps corners to fractions of a pixel, so the edges along u and v move outwards by that
    // fraction.
    let along_u = vec3<f32>(vec3<u32>(0u, 1u, 2u) == vec3<u32>(u));
    let along_v = vec3<f32>(vec3<u32>(0u, 1u, 2u) == vec3<u32>(v));
    let margin = view.margin_px * vec2<f32>(
        voxels_per_pixel(from_eye, along_v, d),
        voxels_per_pixel(from_eye, along_u, d),
    );
    let corner = select(seen - margin, seen + margin, upper);
    from_eye[u] = corner.x - eye.x;
    from_eye[v] = corner.y - eye.y;
    let w = dot(view.clip_w, from_eye);
    return Corner(
        vec4<f32>(dot(view.clip_x, from_eye), dot(view.clip_y, from_eye), depth * w, w),
        layer.xy,
    );
}

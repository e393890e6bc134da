// The smooth surface of one eye: the index map, and beside each voxel the normal at the place that is seen, as the
// complement of its packed form, so that an index map without normals reads as one that has none.

//!include "layout.wgsl"
//!include "level_march.wgsl"

// Rays in coordinates of cells, and the size of their grid.
var<immediate> view: MarchView;
@group(0) @binding(1) var starts: texture_2d<f32>;

@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec2<u32> {
    let pixel = vec2<u32>(position.xy);
    let start = textureLoad(starts, pixel >> vec2<u32>(view.tile_log2), 0).x;
    var texel = vec2<u32>(NO_VOXEL, 0u);
    if start < FAR_AWAY {
        let at = vec2<f32>(pixel) + 0.5;
        let ray = make_ray(view.origin, view.corner + view.step_x * at.x + view.step_y * at.y);
        // Other pictures than the further samples of antialiased ones name the nearest voxels.
        let number = select(naming(view.sample, pixel), -1.0, view.sample == 0u);
        let seen = surface_along(ray, vec3<i32>(view.dims), start, number);
        let voxel = vec3<u32>(seen.voxel);
        let dims = view.dims - vec3<u32>(1u);
        let index = voxel.x + dims.x * (voxel.y + dims.y * voxel.z);
        texel = select(texel, vec2<u32>(index, seen.normal ^ NO_NORMAL), seen.found);
    }
    return texel;
}

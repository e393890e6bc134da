// The shaded colour of a voxel: from its colour, normal, ambient occlusion and shadow.

//!include "normal.wgsl"
//!include "normal_field.wgsl"
//!include "colours.wgsl"
//!include "lighting.wgsl"
//!include "shadow.wgsl"

// `between`: the packed normal of the place that is seen, if it is not that of the voxel.
fn shaded(voxel: vec3<i32>, between: u32) -> vec3<f32> {
    let dims = vec3<i32>(shading.dims);
    let colour = colour_of(voxel, shading.base, shading.bricks);
    var record = NO_RECORD;
    if kind_occlusion != 0u || between == NO_NORMAL {
        record = surface_record(voxel, shading.bricks);
    }
    var open = 1.0;
    if kind_occlusion != 0u {
        if record == NO_RECORD {
            open = openness(voxel, dims);
        } else {
            open = f32(record >> 24u) * (1.0 / 255.0);
        }
    }
    var packed = between;
    if packed == NO_NORMAL {
        packed = record & 0xffffu;
    }
    // Without a side that is outside: it faces the eye.
    var outwards = vec3<f32>(0.0);
    if packed != NO_NORMAL {
        outwards = unpacked_normal(packed);
    } else if kind_estimates != 0u {
        outwards = gradient(voxel, dims);
    }
    var sunlit = 1.0;
    if kind_shadow != 0u {
        sunlit = sun_reaching(voxel, outwards, dims);
    }
    return lit(vec3<f32>(voxel) + 0.5, outwards, colour, open, sunlit);
}

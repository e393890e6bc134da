// The colour of a voxel: a table with a page number per brick (0: not painted), then pages of 512 packed
// colours, laid out as in src/render/colours.rs and packed as in core/src/sculpture/colour.rs.

//!include "kind.wgsl"

@group(0) @binding(4) var<storage, read> colours: array<u32>;

// Level out of `steps` + 1 as 0 to 1, rounded to the nearest of 256 levels.
fn expand(level: u32, steps: f32) -> f32 {
    return floor((f32(level) * 255.0 + floor(0.5 * steps) + 0.5) / steps) / 255.0;
}

// sRGB, 0 to 1.
fn colour_of(voxel: vec3<i32>, base: vec3<f32>, bricks: vec3<u32>) -> vec3<f32> {
    let bytes = kind_colour_bytes;
    if bytes == 0u {
        return base;
    }
    let v = vec3<u32>(voxel);
    let brick = v >> vec3<u32>(3u);
    let page = colours[brick.x + bricks.x * (brick.y + bricks.y * brick.z)];
    if page == 0u {
        return base;
    }
    let half = (v >> vec3<u32>(2u)) & vec3<u32>(1u);
    let in_word = v & vec3<u32>(3u);
    let local = (half.x << 6u) | (half.y << 7u) | (half.z << 8u)
        | in_word.x | (in_word.y << 2u) | (in_word.z << 4u);
    // Pages are numbered from 1; offsets are in words.
    let table = bricks.x * bricks.y * bricks.z;
    let start = table + (page - 1u) * 128u * bytes;
    let at = local * bytes;
    let first = colours[start + (at >> 2u)];
    let shift = 8u * (at & 3u);
    if bytes == 1u {
        let c = first >> shift;
        return vec3<f32>(
            expand(c & 3u, 3.0),
            expand((c >> 4u) & 15u, 15.0),
            expand((c >> 2u) & 3u, 3.0),
        );
    }
    if bytes == 2u {
        let c = first >> shift;
        return vec3<f32>(
            expand(c & 15u, 15.0),
            expand((c >> 9u) & 127u, 127.0),
            expand((c >> 4u) & 31u, 31.0),
        );
    }
    // Three bytes may straddle two words.
    let second = colours[start + ((at + 2u) >> 2u)];
    let c = (first >> shift) | select(second << (32u - shift), 0u, shift == 0u);
    let rgb = vec3<u32>(c, c >> 8u, c >> 16u) & vec3<u32>(255u);
    return vec3<f32>(rgb) / 255.0;
}

//! The layouts of the data that CPU and shaders share: the twin of `shaders/layout.wgsl`. A test
//! compares the two member by member.

use bytemuck::{Pod, Zeroable};

/// Makes a `repr(C)` struct that lists its members with their offsets and sizes.
macro_rules! shared {
    ($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, PartialEq, Debug, Default, Pod, Zeroable)]
        pub struct $name { $($(#[$field_meta])* pub $field: $type,)* }

        #[cfg(test)]
        impl $name {
            fn members() -> Vec<(&'static str, usize, usize)> {
                vec![$((
                    stringify!($field),
                    std::mem::offset_of!($name, $field),
                    size_of::<$type>(),
                ),)*]
            }
        }
    };
}

shared! {
    /// Push constants of the slicing pass: one eye's rays, in grid coordinates.
    SliceView {
        /// The eye.
        origin: [f32; 3],
        /// The axis across the layers, 0..3.
        axis: u32,
        /// Direction through the picture's upper left corner.
        corner: [f32; 3],
        /// Distance between layers in depth.
        depth_step: f32,
        /// Change of direction per pixel to the right.
        step_x: [f32; 3],
        /// Largest displacement of a corner by the device, in pixels.
        margin_px: f32,
        /// Change of direction per pixel downwards.
        step_y: [f32; 3],
        /// The bricks that are hit as a whole ([`crate::surface::SmallBricks`]).
        small_least: i32,
        /// Clip coordinates of a point p are these times `p - origin`.
        clip_x: [f32; 3],
        small_x: i32,
        clip_y: [f32; 3],
        small_y: i32,
        clip_w: [f32; 3],
        small_z: i32,
        /// Size of the grid in voxels.
        dims: [u32; 3],
        pad_0: u32,
    }
}

shared! {
    /// Push constants of the composite pass: one eye's index map and its place in the target.
    CompositeView {
        /// The eye, in grid coordinates.
        origin: [f32; 3],
        /// Depth of a point is `(depth_slope * t + depth_at_0) / t` at the distance `t` from the
        /// eye's plane.
        depth_slope: f32,
        /// Direction through the picture's upper left corner.
        corner: [f32; 3],
        depth_at_0: f32,
        /// Change of direction per pixel of the map to the right.
        step_x: [f32; 3],
        /// Pixels of the map per pixel of the target.
        scale_x: f32,
        /// Change of direction per pixel of the map downwards.
        step_y: [f32; 3],
        scale_y: f32,
        /// Size of the grid in voxels.
        dims: [u32; 3],
        /// Binary logarithm of the edge of a beam's tile in pixels of the map.
        tile_log2: u32,
        /// Colour of the background at the top, as the target stores it.
        top: [f32; 3],
        /// Left edge of the eye's viewport in the target, in pixels.
        left: f32,
        /// Colour of the background at the bottom.
        bottom: [f32; 3],
        /// Upper edge of the eye's viewport in the target, in pixels.
        upper: f32,
        /// Size of the map in pixels.
        size: [u32; 2],
        /// 1 where the target takes linear values and encodes them itself.
        linear: u32,
        pad_0: u32,
    }
}

shared! {
    /// Push constants of beams and marches: one eye's rays, in coordinates of the grid or of its cells.
    MarchView {
        /// The eye.
        origin: [f32; 3],
        /// Pixels in a row.
        width: u32,
        /// Direction through the picture's upper left corner.
        corner: [f32; 3],
        /// Rows of pixels.
        height: u32,
        /// Change of direction per pixel to the right.
        step_x: [f32; 3],
        /// Binary logarithm of the edge of a beam's tile in pixels.
        tile_log2: u32,
        /// Change of direction per pixel downwards.
        step_y: [f32; 3],
        /// Index of the sample of an antialiased picture.
        sample: u32,
        /// Size of the grid in voxels.
        dims: [u32; 3],
        /// The bricks that are hit as a whole ([`crate::surface::SmallBricks`]).
        small_least: i32,
        small_weights: [i32; 3],
        pad_0: u32,
    }
}

shared! {
    /// The uniforms of every shader that lights surfaces.
    Shading {
        /// Rows of the map from grid coordinates to eye space.
        eye_from_grid: [[f32; 4]; 3],
        /// Rows of the map that takes covectors of grid coordinates to eye space; the last member
        /// of each is 0.
        normal_from_gradient: [[f32; 4]; 3],
        /// Lights in eye space: a direction, or a position with w = 1.
        sources: [[f32; 4]; 4],
        /// Their linear colours times intensity.
        radiances: [[f32; 4]; 4],
        /// Linear, on a surface that faces the horizon.
        ambient: [f32; 3],
        specular: f32,
        /// Colour of voxels that are not painted, sRGB.
        base: [f32; 3],
        shininess: u32,
        /// Size of the grid in voxels.
        dims: [u32; 3],
        /// The last coefficient of the tone curve.
        tone_floor: f32,
        /// Size of the grid in bricks.
        bricks: [u32; 3],
        /// The bricks that are hit as a whole ([`crate::surface::SmallBricks`]).
        small_least: i32,
        /// Additional ambient light on a surface that faces the sky.
        ambient_slope: [f32; 3],
        /// The light that casts shadows; all ones for none.
        sun_light: u32,
        /// Direction to the sky, in eye space.
        up: [f32; 3],
        /// The number of the sample of an antialiased picture.
        sun_sample: u32,
        /// The other coefficients of the tone curve.
        tone: [f32; 4],
        /// Direction to the middle of the sun's disc, and from there to its edge, in grid coordinates.
        sun_towards: [f32; 3],
        small_x: i32,
        sun_right: [f32; 3],
        small_y: i32,
        sun_up: [f32; 3],
        small_z: i32,
    }
}

shared! {
    /// Push constants of the stereo pass: the place of the pictures in the window.
    StereoView {
        /// Size of the window in pixels.
        window: [u32; 2],
        /// Size of the pictures in pixels.
        size: [u32; 2],
        /// Their upper left corner in the window.
        corner: [i32; 2],
        /// The eye of the target, if targets are for one eye.
        eye: u32,
        pad_0: u32,
    }
}

shared! {
    /// Push constants of the passes of the mean of pictures.
    MeanView {
        /// The share of the picture in the mean.
        weight: f32,
        /// 1 if the device decodes and encodes the pictures.
        linear: u32,
    }
}

shared! {
    /// Push constants of the pass that smooths edges.
    EdgesView {
        /// The size of the picture in pixels.
        size: [u32; 2],
        /// Times the square of the nearness of a surface: the least difference to another surface.
        leap: f32,
        /// 1 if the device decodes and encodes the picture.
        linear: u32,
    }
}

shared! {
    /// Push constants of the ground pass: see [`crate::shade::GroundPicture`].
    GroundView {
        rows: [[f32; 4]; 3],
        light: [[f32; 4]; 3],
        tone: [f32; 4],
        lines: [f32; 4],
    }
}

shared! {
    /// Push constants of the backdrop pass: a video frame and its lens.
    BackdropView {
        /// The position in the frame (0 to 1) is that on the screen times this, plus `offset`.
        scale: [f32; 2],
        offset: [f32; 2],
        /// Focal lengths and centre of the lens in pixels of the frame.
        focal: [f32; 2],
        centre: [f32; 2],
        /// Radial distortion.
        radial: [f32; 3],
        /// 1 to undistort the frame.
        lens: u32,
        /// Colour beyond the frame, as the target stores it.
        beyond: [f32; 3],
        pad_0: u32,
        /// Tangential distortion.
        tangential: [f32; 2],
        /// Size of the screen in pixels.
        screen: [f32; 2],
        /// Size of the frame in pixels.
        size: [u32; 2],
        pad_1: [u32; 2],
    }
}

shared! {
    /// Push constants of the points pass: one eye.
    PointView {
        /// The eye, in grid coordinates.
        origin: [f32; 3],
        /// As in [`CompositeView`].
        depth_slope: f32,
        /// Direction through the picture's upper left corner.
        corner: [f32; 3],
        depth_at_0: f32,
        /// Change of direction per pixel to the right.
        step_x: [f32; 3],
        /// Left edge of the eye's viewport in the target, in pixels.
        left: f32,
        /// Change of direction per pixel downwards.
        step_y: [f32; 3],
        /// Upper edge of the eye's viewport in the target, in pixels.
        upper: f32,
        /// Clip coordinates of a point p are these times `p - origin`.
        clip_x: [f32; 3],
        /// 1 where the target takes linear values and encodes them itself.
        linear: u32,
        clip_y: [f32; 3],
        /// Largest displacement of a corner by the device, in clip coordinates, with a margin for rounding.
        margin_x: f32,
        clip_w: [f32; 3],
        margin_y: f32,
    }
}

/// One instance of the slicing pass (vertex attributes, so only the pipeline defines its layout).
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Pod, Zeroable)]
pub struct SliceInstance {
    /// Lower and upper u, lower and upper v, in voxels.
    pub rect: [u16; 4],
    /// Lower and upper plane in voxels, rank, 1 where it covers the picture.
    pub layer: [u16; 4],
}

shared! {
    /// Uniforms of the tracer of final pictures: [`crate::trace::PreparedTrace`], and the grid.
    TraceScene {
        /// Rows of the placement of the grid.
        world_from_grid: [[f32; 4]; 3],
        /// Rows of its inverse, for directions.
        grid_from_world: [[f32; 4]; 3],
        /// Rows that map normals of the grid to the world.
        world_from_normal: [[f32; 4]; 3],
        /// Up in the world.
        up: [f32; 3],
        /// The radius of the ball about the sculpture, in the world.
        radius: f32,
        /// The box around all voxels.
        low: [f32; 3],
        /// Height of the grid's origin over the ground.
        ground_offset: f32,
        high: [f32; 3],
        /// Sine of the angular radius of the sun.
        sun_sine: f32,
        /// The middle of the box.
        middle: [f32; 3],
        /// The area of the lamp, in the world.
        lamp_area: f32,
        /// Gives the height of points of the grid over the ground.
        ground_height: [f32; 3],
        /// Distance of sharp focus, in lengths of the rays' directions.
        focus: f32,
        ground_albedo: [f32; 3],
        pad_0: u32,
        /// The light from ground without a shadow.
        open_ground: [f32; 3],
        pad_1: u32,
        towards_sun: [f32; 3],
        pad_2: u32,
        sun_irradiance: [f32; 3],
        pad_3: u32,
        sun_radiance: [f32; 3],
        pad_4: u32,
        /// The sky: see `trace::Gradient`.
        zenith: [f32; 3],
        pad_5: u32,
        horizon: [f32; 3],
        pad_6: u32,
        glow: [f32; 3],
        pad_7: u32,
        below: [f32; 3],
        pad_8: u32,
        /// The lamp: see `trace::Lamp`.
        lamp_centre: [f32; 3],
        pad_9: u32,
        lamp_u: [f32; 3],
        pad_10: u32,
        lamp_v: [f32; 3],
        pad_11: u32,
        lamp_normal: [f32; 3],
        pad_12: u32,
        lamp_radiance: [f32; 3],
        pad_13: u32,
        /// Radii of the pupil, in grid coordinates.
        pupil_right: [f32; 3],
        pad_14: u32,
        pupil_up: [f32; 3],
        pad_15: u32,
        /// sRGB, 0 to 1.
        base: [f32; 3],
        pad_16: u32,
        /// Size of the grid in voxels.
        dims: [u32; 3],
        pad_17: u32,
        bricks: [u32; 3],
        pad_18: u32,
    }
}

shared! {
    /// Push constants of the tracer: the rays of a pass, and the first row of a band.
    TraceRays {
        /// The eye.
        origin: [f32; 3],
        /// The number of the pass.
        index: u32,
        /// Direction through the picture's upper left corner.
        corner: [f32; 3],
        /// The width of the picture, in pixels.
        width: u32,
        /// Change of direction per pixel to the right.
        step_x: [f32; 3],
        height: u32,
        /// Change of direction per pixel downwards.
        step_y: [f32; 3],
        first_row: u32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the members of a struct in the source of a stage, as (name, offset, size), without padding.
    fn wgsl_members(text: &str, name: &str) -> (Vec<(String, usize, usize)>, usize) {
        let module = naga::front::wgsl::parse_str(text).unwrap();
        let context = module.to_ctx();
        let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name));
        let naga::TypeInner::Struct { members, span } = &found.unwrap().1.inner else {
            panic!("{name} is no struct");
        };
        let members = members.iter().map(|m| {
            let size = module.types[m.ty].inner.size(context) as usize;
            (m.name.clone().unwrap(), m.offset as usize, size)
        });
        (members.collect(), *span as usize)
    }

    fn compare(text: &str, name: &str, ours: Vec<(&'static str, usize, usize)>, bytes: usize) {
        let (theirs, span) = wgsl_members(text, name);
        let ours: Vec<_> = ours
            .into_iter()
            .filter(|(member, ..)| !member.starts_with("pad_"))
            .map(|(member, offset, size)| (member.to_string(), offset, size))
            .collect();
        assert_eq!(ours, theirs, "{name}");
        assert_eq!(bytes, span, "{name}");
    }

    macro_rules! stage {
        ($file:literal) => {
            include_str!(concat!(env!("OUT_DIR"), "/", $file))
        };
    }

    #[test]
    fn layouts_are_those_of_the_shaders() {
        for text in [stage!("slicing.vert.wgsl"), stage!("slicing.frag.wgsl")] {
            compare(text, "SliceView", SliceView::members(), size_of::<SliceView>());
        }
        let (members, bytes) = (CompositeView::members(), size_of::<CompositeView>());
        for text in [
            stage!("composite.frag.wgsl"),
            stage!("composite_linear.frag.wgsl"),
            stage!("gpu_only.frag.wgsl"),
        ] {
            compare(text, "CompositeView", members.clone(), bytes);
        }
        let (members, bytes) = (StereoView::members(), size_of::<StereoView>());
        compare(stage!("stereo.frag.wgsl"), "StereoView", members, bytes);
        let (members, bytes) = (MeanView::members(), size_of::<MeanView>());
        for text in [stage!("mean_add.frag.wgsl"), stage!("mean_resolve.frag.wgsl")] {
            compare(text, "MeanView", members.clone(), bytes);
        }
        let text = stage!("trace.comp.wgsl");
        compare(text, "TraceScene", TraceScene::members(), size_of::<TraceScene>());
        compare(text, "TraceRays", TraceRays::members(), size_of::<TraceRays>());
        let (members, bytes) = (EdgesView::members(), size_of::<EdgesView>());
        compare(stage!("smooth_edges.frag.wgsl"), "EdgesView", members, bytes);
        let (members, bytes) = (GroundView::members(), size_of::<GroundView>());
        for text in [stage!("ground.frag.wgsl"), stage!("ground_linear.frag.wgsl")] {
            compare(text, "GroundView", members.clone(), bytes);
        }
        let (members, bytes) = (BackdropView::members(), size_of::<BackdropView>());
        compare(stage!("backdrop.frag.wgsl"), "BackdropView", members, bytes);
        let (members, bytes) = (MarchView::members(), size_of::<MarchView>());
        for text in [
            stage!("beam.comp.wgsl"),
            stage!("beam.frag.wgsl"),
            stage!("ray_march.comp.wgsl"),
            stage!("ray_march.frag.wgsl"),
            stage!("level_march.frag.wgsl"),
        ] {
            compare(text, "MarchView", members.clone(), bytes);
        }
        for text in [stage!("points.vert.wgsl"), stage!("points.frag.wgsl")] {
            compare(text, "PointView", PointView::members(), size_of::<PointView>());
        }
        let (members, bytes) = (Shading::members(), size_of::<Shading>());
        for text in [stage!("shade.comp.wgsl"), stage!("shade.frag.wgsl")] {
            compare(text, "Shading", members.clone(), bytes);
        }
    }
}

//! The smooth surface of near voxels: of a ball, a turned block with edges, and a thin wall.

use glam::{Affine3A, UVec2, Vec3};
use virtual_sculpture::render::{RenderMode, SmoothSurface};
use virtual_sculpture::view::Camera;

use super::paint::{Painter, Scene, document};
use super::record::assert_recorded;
use crate::gpu::fixture::with_device;

#[test]
fn near_voxels_have_a_smooth_surface() {
    with_device(|device| {
        let mut document = document(
            "new dims=48,32,32 colour=24 base=#c8b48c fill=empty\n\
             add ellipsoid at=12,13,18 half=9,9,9 colour=#c8b48c\n\
             add cuboid at=34,13,18 half=7,6,8 turn=20,35,10 colour=#5078b4\n\
             add cuboid at=24,4,16 half=22,1,12 turn=4,0,3 colour=#708060\n",
        );
        let scene = Scene {
            eyes: &[
                Camera::framing(15.0, Vec3::new(0.3, 0.5, 1.0), Vec3::Y).eye(UVec2::new(240, 160))
            ],
            world_from_grid: Affine3A::from_translation(Vec3::new(-24.0, -12.0, -16.0)),
            mode: RenderMode::Ray,
            video: None,
            previews: &[],
        };
        let mut painter = Painter { smooth_surface: SmoothSurface::Always, ..Painter::new(device) };
        let pictures = painter.paint(&mut document, &scene);
        assert_recorded("smooth.png", &pictures[0]);
    });
}

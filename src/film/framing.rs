//! The camera of a film: at rest, so that the whole sculpture is in the picture at every turn.
//!
//! Made from the view of a picture and the sculpture of the last frame, whose placement all frames share. Pure.

use glam::{Affine3A, Quat, Vec3};

use crate::document::Document;
use crate::picture::{CameraPlacement, PictureView, outline, outline_middle, voxel_edge};
use crate::sculpture::Placement;
use crate::view::Eye;

/// Heights at which the sculpture's reach about the axis is measured.
const RINGS: usize = 256;
/// Corners of the polygon around each ring.
const RING_CORNERS: usize = 64;

/// See the module text.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FilmFraming {
    eye: Eye,
    distance: f32,
    placement: Placement,
    up: Vec3,
    /// A point on the axis of the turn.
    pivot: Vec3,
}

impl FilmFraming {
    /// Frames `document` in its state of the last frame. Without a spin, it is framed like a single picture.
    pub fn new(view: &PictureView, document: &Document, spins: bool) -> FilmFraming {
        let (placement, up) = (*document.placement(), view.up);
        if !spins {
            let CameraPlacement { eye, distance, .. } = view.placement(document);
            return FilmFraming { eye, distance, placement, up, pivot: Vec3::ZERO };
        }
        let world_from_grid = document.world_from_grid();
        let pivot = world_from_grid.transform_point3(outline_middle(document.grid()));
        let points = outline(document.grid());
        let points = points.iter().map(|point| world_from_grid.transform_point3(*point));
        let camera = view.camera(&swept(points, up, pivot), voxel_edge(&world_from_grid));
        let (eye, distance) = (camera.eye(view.size), camera.eye.distance(camera.target));
        FilmFraming { eye, distance, placement, up, pivot }
    }

    /// Returns the placement of the camera for a frame in which the sculpture is `document`.
    pub fn placement(&self, document: &Document, turn_rad: f32) -> CameraPlacement {
        let (frame, voxel_size) = (document.contents().frame, document.grid().voxel_size());
        let turn = Affine3A::from_translation(self.pivot)
            * Affine3A::from_quat(Quat::from_axis_angle(self.up, turn_rad))
            * Affine3A::from_translation(-self.pivot);
        let world_from_grid = turn * self.placement.world_from_framed(&frame, voxel_size);
        CameraPlacement { eye: self.eye, world_from_grid, distance: self.distance }
    }
}

/// Returns points around the region swept by `points` about an axis.
fn swept(points: impl Iterator<Item = Vec3> + Clone, axis: Vec3, pivot: Vec3) -> Vec<Vec3> {
    let height = |point: Vec3| (point - pivot).dot(axis);
    let (low, high) = points
        .clone()
        .map(height)
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
    let ring_height = ((high - low) / RINGS as f32).max(f32::MIN_POSITIVE);
    let mut reach = [None::<f32>; RINGS];
    for point in points {
        let ring = ((height(point) - low) / ring_height) as usize;
        let radius = (point - pivot).cross(axis).length();
        let reach = &mut reach[ring.min(RINGS - 1)];
        *reach = Some(reach.map_or(radius, |reach| reach.max(radius)));
    }
    let (across, along) = axis.any_orthonormal_pair();
    // Around the circle, not within it.
    let outer = 1.0 / (std::f32::consts::PI / RING_CORNERS as f32).cos();
    let rings = (0..RINGS).filter_map(|ring| Some((ring, reach[ring]?)));
    let corners = rings.flat_map(|(ring, reach)| {
        [ring, ring + 1].into_iter().flat_map(move |edge| {
            let centre = pivot + axis * (low + ring_height * edge as f32);
            (0..RING_CORNERS).map(move |corner| {
                let angle = std::f32::consts::TAU * corner as f32 / RING_CORNERS as f32;
                let (sin, cos) = angle.sin_cos();
                centre + (across * cos + along * sin) * (reach * outer)
            })
        })
    });
    corners.collect()
}

#[cfg(test)]
mod tests {
    use glam::{UVec2, UVec3};

    use super::*;
    use crate::command::NewSculpture;
    use crate::document::Limits;
    use crate::headless::PictureRequest;
    use crate::render::RenderMode;
    use crate::sculpture::{ColourDepth, Rgb};
    use crate::view::StereoLayout;

    fn view(up: Vec3) -> PictureView {
        PictureView {
            size: UVec2::new(320, 200),
            smooth_surface: true,
            mode: RenderMode::Ray,
            direction: PictureRequest::THREE_QUARTER,
            up,
            turn_rad: 0.3,
            zoom: 1.0,
            orthographic: false,
            fov_y_rad: 0.8,
            stereo: StereoLayout::Mono,
            ground: None,
            samples: 1,
        }
    }

    /// Returns a long bar in a corner of the grid, rotated and moved.
    fn document() -> Document {
        let new = NewSculpture {
            dims: UVec3::new(96, 64, 48),
            voxel_size: Vec3::new(1.0, 1.5, 1.0),
            colour_depth: ColourDepth::Bits8,
            base: Rgb([128; 3]),
            solid: false,
            room_vx: 0,
            grows: false,
        };
        let mut document = Document::new(&new, Limits::default()).unwrap();
        for line in
            ["add cuboid at=40,20,30 half=38,6,9", "place turn=20,30,40 move=5,-7,30 scale=0.5"]
        {
            document.apply(&line.parse().unwrap()).unwrap();
        }
        document
    }

    /// Returns the greatest distance of the sculpture from the centre of the picture; 1 is at the edge.
    fn reach(placement: &CameraPlacement, document: &Document) -> f32 {
        let eye = &placement.eye;
        let points = outline(document.grid()).into_iter().map(|point| {
            let world = placement.world_from_grid.transform_point3(point);
            let clip = eye.projection * eye.eye_from_world.transform_point3(world).extend(1.0);
            assert!(clip.w > 0.0, "in front of the eye");
            (clip.x.abs() / clip.w).max(clip.y.abs() / clip.w)
        });
        points.fold(0.0, f32::max)
    }

    #[test]
    fn the_whole_sculpture_is_in_every_frame_of_a_turn_and_fills_the_picture() {
        let document = document();
        for up in [Vec3::Y, Vec3::Z, Vec3::NEG_X] {
            let framing = FilmFraming::new(&view(up), &document, true);
            let reaches: Vec<f32> = (0..90)
                .map(|frame| {
                    reach(
                        &framing.placement(&document, (4.0 * frame as f32).to_radians()),
                        &document,
                    )
                })
                .collect();
            let most = reaches.iter().copied().fold(0.0, f32::max);
            assert!((0.80..0.94).contains(&most), "{up}: {most}");
        }
    }

    #[test]
    fn a_turn_in_parallel_rays_is_framed_as_well() {
        let document = document();
        let view = PictureView { orthographic: true, ..view(Vec3::Y) };
        let framing = FilmFraming::new(&view, &document, true);
        let turns = (0..36).map(|frame| (10.0 * frame as f32).to_radians());
        let most = turns.map(|turn| reach(&framing.placement(&document, turn), &document));
        let most = most.fold(0.0, f32::max);
        assert!((0.86..0.935).contains(&most), "{most}");
    }

    #[test]
    fn the_axis_of_a_turn_goes_through_the_middle_of_the_sculpture() {
        let document = document();
        let framing = FilmFraming::new(&view(Vec3::Y), &document, true);
        let middle = outline_middle(document.grid());
        let at = |turn| framing.placement(&document, turn).world_from_grid.transform_point3(middle);
        for turn in [0.0, 1.0, 2.5, 6.0] {
            assert!(at(turn).abs_diff_eq(at(0.3), 1e-3), "{turn}: {} {}", at(turn), at(0.3));
        }
    }

    #[test]
    fn a_film_without_a_turn_is_framed_as_a_picture_is() {
        let document = document();
        let view = view(Vec3::Z);
        let placement =
            FilmFraming::new(&view, &document, false).placement(&document, view.turn_rad);
        assert_eq!(placement, view.placement(&document));
    }
}

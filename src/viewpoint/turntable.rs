//! The turntable camera: it stays on the z axis and looks at the origin, while the sculpture turns and
//! shifts before it.
//!
//! Returns new [`Placement`]s for the document and an [`Eye`] for the picture; the only state is the
//! camera's distance and the size of the picture.

use glam::{Mat3, Quat, UVec2, Vec2, Vec3};

use crate::input::Side;
use crate::sculpture::{Grid, Placement};
use crate::view::{Camera, Eye};

/// Turn for a drag across the height of the picture.
const TURN_PER_HEIGHT_RAD: f32 = 1.25 * std::f32::consts::PI;
/// Factor on the distance for one notch of the wheel.
const ZOOM_PER_NOTCH: f32 = 0.88;
/// Least and greatest distance of the camera from the sculpture's centre, in radii of the sculpture.
const NEAREST: f32 = 0.02;
const FARTHEST: f32 = 50.0;
/// Space around the sculpture when all of it is shown.
const MARGIN: f32 = 1.02;

/// The camera before the sculpture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Turntable {
    /// The distance from the camera to the origin, in world units.
    distance: f32,
    /// The radius of the ball around the grid, in world units.
    radius: f32,
    /// The same radius, in voxels.
    radius_vx: f32,
    /// Uses parallel rays. Distances are those of a perspective camera with the same extent.
    orthographic: bool,
    fov_y_rad: f32,
    /// Pixels of the picture.
    size: UVec2,
}

impl Turntable {
    /// Returns a camera that shows the whole of `grid`.
    pub fn new(grid: &Grid, fov_deg: f32, size: UVec2) -> Turntable {
        let mut turntable = Turntable {
            distance: 1.0,
            radius: 1.0,
            radius_vx: 1.0,
            orthographic: false,
            fov_y_rad: fov_deg.to_radians(),
            size,
        };
        turntable.show_all(grid, &Placement::default());
        turntable
    }

    pub fn set_size(&mut self, size: UVec2) {
        self.size = size.max(UVec2::ONE);
    }

    /// Switches between orthographic and perspective projection.
    pub fn set_orthographic(&mut self, orthographic: bool) {
        self.orthographic = orthographic;
    }

    pub fn camera(&self) -> Camera {
        let camera = Camera {
            eye: Vec3::new(0.0, 0.0, self.distance),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_y_rad: self.fov_y_rad,
            near: self.near(),
        };
        match self.orthographic {
            true => camera.orthographic(2.0 * self.radius, 2.0 * self.radius_vx),
            false => camera,
        }
    }

    /// Returns the distance of the near plane for a camera within the scene.
    pub fn near(&self) -> f32 {
        self.distance.min(self.radius) * 1e-3
    }

    pub fn eye(&self) -> Eye {
        self.camera().eye(self.size)
    }

    /// Returns the middle of the picture, in pixels.
    pub fn middle(&self) -> Vec2 {
        self.size.as_vec2() * 0.5
    }

    /// Returns the visible height at the distance of the origin, in world units.
    pub fn window_height(&self) -> f32 {
        2.0 * (0.5 * self.fov_y_rad).tan() * self.distance
    }

    /// Sets the distance at which the whole grid is visible in any rotation.
    pub fn show_all(&mut self, grid: &Grid, placement: &Placement) {
        let extent = grid.dims().as_vec3() * grid.voxel_size() * placement.scale;
        self.radius = 0.5 * extent.length();
        self.radius_vx = 0.5 * grid.dims().as_vec3().length();
        let aspect = self.size.x as f32 / self.size.y as f32;
        let half_angle = (0.5 * self.fov_y_rad).tan() * aspect.min(1.0);
        self.distance = MARGIN * self.radius / half_angle.atan().sin();
    }

    /// Returns the placement with a side of the grid facing the viewer, `up` of the grid upwards.
    pub fn looking_from(&self, side: Side, up: Vec3, placement: &Placement) -> Placement {
        Placement { rotation: facing(side, up), translation: Vec3::ZERO, ..*placement }
    }

    /// Turns the sculpture like an object on a tilting turntable: across the screen about its own `up` axis, up and
    /// down about the screen's horizontal. It never rolls.
    pub fn turned(&self, placement: &Placement, by: Vec2, up: Vec3) -> Placement {
        self.turned_by(placement, by * (TURN_PER_HEIGHT_RAD / self.size.y as f32), up)
    }

    /// Turns likewise by angles in radians: to the right, and down.
    pub fn turned_by(&self, placement: &Placement, angle: Vec2, up: Vec3) -> Placement {
        let axis = placement.rotation * up;
        // Upside down, the sculpture must still follow the hand.
        let sense = if axis.y < -1e-3 { -1.0 } else { 1.0 };
        let spin = Quat::from_axis_angle(axis.normalize_or(Vec3::Y), sense * angle.x);
        let tilt = Quat::from_rotation_x(angle.y);
        Placement { rotation: (tilt * spin * placement.rotation).normalize(), ..*placement }
    }

    /// Returns the turn of a drag about the screen's axes, in world coordinates, for tools.
    pub fn turn_of(&self, by: Vec2) -> Quat {
        let angle = by * (TURN_PER_HEIGHT_RAD / self.size.y as f32);
        Quat::from_rotation_x(angle.y) * Quat::from_rotation_y(angle.x)
    }

    /// Shifts the sculpture so that its centre follows the pointer.
    pub fn shifted(&self, placement: &Placement, by: Vec2) -> Placement {
        let shift = Vec3::new(by.x, -by.y, 0.0) * self.world_per_pixel(placement);
        Placement { translation: placement.translation + shift, ..*placement }
    }

    /// Brings the sculpture nearer by as much as a drag of `pixels` across would move it, but not beyond visibility,
    /// nor closer than a surface at the distance `surface` before the camera. With parallel rays, where that has no
    /// effect, the picture is magnified instead.
    pub fn brought_nearer(
        &mut self,
        placement: &Placement,
        pixels: f32,
        surface: Option<f32>,
    ) -> Placement {
        if self.orthographic {
            let range = self.radius * NEAREST..=self.radius * FARTHEST;
            let to = self.distance - pixels * self.world_per_pixel(placement);
            self.distance = to.clamp(*range.start(), *range.end());
            return *placement;
        }
        let room = surface.map_or(f32::INFINITY, |surface| (surface - self.gap()).max(0.0));
        let nearest = self.distance - self.radius * NEAREST;
        let farthest = self.distance - self.radius * FARTHEST;
        let z = placement.translation.z;
        let by = (pixels * self.world_per_pixel(placement)).min(room);
        let to = (z + by).clamp(farthest.min(z), nearest.max(z));
        Placement { translation: placement.translation.with_z(to), ..*placement }
    }

    /// Returns the least distance of the camera from a surface, in world units.
    pub fn gap(&self) -> f32 {
        self.radius * NEAREST
    }

    /// Zooms by notches; the point under the pointer stays there. `surface`: distance of the surface under the pointer
    /// from the camera, which is approached and never reached. Without one, the camera approaches the depth of the
    /// sculpture's centre.
    pub fn zoomed(
        &mut self,
        placement: &Placement,
        notches: f32,
        at: Vec2,
        surface: Option<f32>,
    ) -> Placement {
        let factor = ZOOM_PER_NOTCH.powf(notches.clamp(-20.0, 20.0));
        match surface.filter(|_| !self.orthographic) {
            Some(surface) => {
                let to = match factor < 1.0 {
                    true => (surface * factor).max(self.gap()).min(surface),
                    false => surface.max(self.gap()) * factor,
                };
                self.advanced(placement, surface - to, at)
            }
            None => self.advanced(placement, self.distance * (1.0 - factor), at),
        }
    }

    /// Moves the camera forwards by world units, along the ray of the pixel `at`.
    pub fn advanced(&mut self, placement: &Placement, by: f32, at: Vec2) -> Placement {
        let from_middle = (at - self.size.as_vec2() * 0.5) * Vec2::new(1.0, -1.0);
        let before = self.world_per_pixel(placement);
        let range = self.radius * NEAREST..=self.radius * FARTHEST;
        self.distance = (self.distance - by).clamp(*range.start(), *range.end());
        let shift = from_middle * (self.world_per_pixel(placement) - before);
        Placement { translation: placement.translation + shift.extend(0.0), ..*placement }
    }

    /// Returns world units per pixel at the depth of the sculpture's centre.
    fn world_per_pixel(&self, placement: &Placement) -> f32 {
        if self.orthographic {
            return self.window_height() / self.size.y as f32;
        }
        let depth = (self.distance - placement.translation.z).max(self.radius * 1e-3);
        2.0 * (0.5 * self.fov_y_rad).tan() * depth / self.size.y as f32
    }
}

/// Returns the side of the view in which `axis` of the grid points at the viewer, with `up` of the grid upwards.
pub fn side_facing(axis: Vec3, up: Vec3) -> Option<Side> {
    let sides = Side::ALL.into_iter().filter(|side| *side != Side::Corner);
    sides.into_iter().find(|side| (facing(*side, up) * axis).z > 0.99)
}

/// Returns the rotation that turns a side of the grid to the viewer, `up` of the grid upwards.
fn facing(side: Side, up: Vec3) -> Quat {
    Quat::from_mat3(&side_frame(side, up).transpose()).normalize()
}

/// Returns the directions to the right, up and towards a viewer of `side`, with `up` of the grid upwards, as axes of
/// the grid.
pub fn side_frame(side: Side, up: Vec3) -> Mat3 {
    // A right-handed frame of the grid with `up` upwards; the front looks along `front`.
    let front = if up.z.abs() > 0.5 { Vec3::NEG_Y * up.z.signum() } else { Vec3::Z };
    let right = up.cross(front);
    let (towards, upwards) = match side {
        Side::Front => (front, up),
        Side::Back => (-front, up),
        Side::Right => (right, up),
        Side::Left => (-right, up),
        Side::Top => (up, -front),
        Side::Bottom => (-up, front),
        Side::Corner => (right * 0.8 + up * 0.6 + front, up),
    };
    let z = towards.normalize();
    let x = upwards.cross(z).normalize();
    Mat3::from_cols(x, z.cross(x), z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec3;

    fn turntable() -> (Grid, Turntable) {
        let grid = Grid::new(UVec3::new(20, 10, 30), Vec3::ONE, 1 << 30).unwrap();
        let turntable = Turntable::new(&grid, 45.0, UVec2::new(640, 480));
        (grid, turntable)
    }

    #[test]
    fn every_side_comes_to_the_front() {
        let (_, turntable) = turntable();
        let placement = Placement::default();
        let faces = |side, up, axis: Vec3| {
            let rotation = turntable.looking_from(side, up, &placement).rotation;
            assert!((rotation * axis).abs_diff_eq(Vec3::Z, 1e-5), "{side:?} {up}");
            if !matches!(side, Side::Top | Side::Bottom) {
                assert!((rotation * up).abs_diff_eq(Vec3::Y, 1e-5), "{side:?} {up}");
            }
        };
        faces(Side::Front, Vec3::Y, Vec3::Z);
        faces(Side::Back, Vec3::Y, Vec3::NEG_Z);
        faces(Side::Right, Vec3::Y, Vec3::X);
        faces(Side::Left, Vec3::Y, Vec3::NEG_X);
        faces(Side::Top, Vec3::Y, Vec3::Y);
        faces(Side::Bottom, Vec3::Y, Vec3::NEG_Y);
        for up in [Vec3::X, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
            faces(Side::Top, up, up);
        }
        faces(Side::Front, Vec3::Z, Vec3::NEG_Y);
        let corner = turntable.looking_from(Side::Corner, Vec3::Y, &placement).rotation;
        let seen = corner * Vec3::new(0.8, 0.6, 1.0).normalize();
        assert!(seen.abs_diff_eq(Vec3::Z, 1e-5));
    }

    #[test]
    fn every_axis_has_the_side_from_which_it_points_to_the_viewer() {
        for up in [Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::NEG_X] {
            for axis in Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                let side = side_facing(axis, up).unwrap();
                assert!((facing(side, up) * axis).abs_diff_eq(Vec3::Z, 1e-5), "{up} {axis}");
            }
        }
        assert_eq!(side_facing(Vec3::Y, Vec3::Y), Some(Side::Top));
        assert_eq!(side_facing(Vec3::NEG_X, Vec3::Y), Some(Side::Left));
        assert_eq!(side_facing(Vec3::ONE.normalize(), Vec3::Y), None);
    }

    #[test]
    fn all_corners_are_in_the_picture_however_the_grid_is_turned() {
        let (grid, mut turntable) = turntable();
        for size in [UVec2::new(640, 480), UVec2::new(300, 900)] {
            turntable.set_size(size);
            turntable.show_all(&grid, &Placement::default());
            for side in Side::ALL {
                let placement = turntable.looking_from(side, Vec3::Y, &Placement::default());
                let world_from_grid = placement.world_from_grid(grid.dims(), grid.voxel_size());
                let clip_from_grid = turntable.eye().clip_from_grid(&world_from_grid);
                for i in 0..8 {
                    let corner = Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
                    let clip = clip_from_grid * (corner * grid.dims().as_vec3()).extend(1.0);
                    assert!(clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.z < clip.w);
                }
            }
        }
    }

    #[test]
    fn the_front_follows_the_hand() {
        let (_, turntable) = turntable();
        let by = |by, placement: &Placement| turntable.turned(placement, by, Vec3::Y).rotation;
        let rest = Placement::default();
        assert!((by(Vec2::new(10.0, 0.0), &rest) * Vec3::Z).x > 0.0, "right is right");
        assert!((by(Vec2::new(0.0, 10.0), &rest) * Vec3::Z).y < 0.0, "down is down");
        let head_down = Placement { rotation: Quat::from_rotation_z(std::f32::consts::PI), ..rest };
        assert!((by(Vec2::new(10.0, 0.0), &head_down) * Vec3::Z).x > 0.0, "also upside down");
        let mut placement = rest;
        for i in 0..100 {
            let wobble = Vec2::new((i % 7) as f32 * 9.0, (i % 5) as f32 - 2.0);
            placement = turntable.turned(&placement, wobble, Vec3::Y);
            assert!((placement.rotation * Vec3::Y).x.abs() < 1e-3, "never rolls");
        }
    }

    #[test]
    fn zooming_and_shifting_keep_what_is_under_the_pointer() {
        let (grid, perspective) = turntable();
        keep_what_is_under_the_pointer(&grid, perspective);
        let mut parallel = perspective;
        parallel.set_orthographic(true);
        keep_what_is_under_the_pointer(&grid, parallel);
    }

    fn keep_what_is_under_the_pointer(grid: &Grid, mut turntable: Turntable) {
        let placement = Placement { translation: Vec3::new(1.0, 2.0, 0.0), ..Default::default() };
        let centre = grid.dims().as_vec3() * 0.5;
        let pixel = |turntable: &Turntable, placement: &Placement| {
            let world_from_grid = placement.world_from_grid(grid.dims(), grid.voxel_size());
            let clip = turntable.eye().clip_from_grid(&world_from_grid) * centre.extend(1.0);
            (Vec2::new(clip.x, clip.y) / clip.w * 0.5 + 0.5) * turntable.size.as_vec2()
        };
        let at = pixel(&turntable, &placement);
        let zoomed = turntable.zoomed(&placement, 5.0, at, None);
        assert!(pixel(&turntable, &zoomed).abs_diff_eq(at, 0.1));
        let shifted = turntable.shifted(&zoomed, Vec2::new(30.0, -12.0));
        assert!(pixel(&turntable, &shifted).abs_diff_eq(at + Vec2::new(30.0, -12.0), 0.1));
    }

    #[test]
    fn a_nearer_sculpture_is_larger_in_either_projection() {
        let (grid, mut turntable) = turntable();
        for orthographic in [false, true] {
            turntable.set_orthographic(orthographic);
            turntable.show_all(&grid, &Placement::default());
            let width = |turntable: &Turntable, placement: &Placement| {
                let world_from_grid = placement.world_from_grid(grid.dims(), grid.voxel_size());
                let clip_from_grid = turntable.eye().clip_from_grid(&world_from_grid);
                let [a, b] = [0.0, 20.0].map(|x| {
                    let clip = clip_from_grid * Vec3::new(x, 5.0, 15.0).extend(1.0);
                    clip.x / clip.w * 320.0
                });
                b - a
            };
            let before = width(&turntable, &Placement::default());
            let nearer = turntable.brought_nearer(&Placement::default(), 60.0, None);
            let after = width(&turntable, &nearer);
            assert!((1.1..1.3).contains(&(after / before)), "{before} {after}");
        }
    }
}

//! A box: its base is dragged on a face, in whole voxels; its height is fixed or follows the pointer.
//!
//! Takes a face and pixels; gives the corners of the box and a cuboid.

use glam::{Quat, Vec2, Vec3};

use super::view::DrawView;
use crate::picking::SurfacePoint;
use crate::tools::solid::{Primitive, Solid};

/// If the visible share of the face's normal is less than this, it nearly points at the eye. Then the pointer sets the
/// height by going up and down in the picture instead of along the normal.
const LEAST_SEEN: f32 = 0.25;

/// The base of a box, in the plane of a face.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Base {
    /// Its lowest and its highest corner in the plane, in whole voxels.
    low: Vec3,
    high: Vec3,
    /// Unit vector out of the face, along an axis.
    face: Vec3,
    /// End of its drag in the plane, perhaps beside the grid.
    end: Vec3,
}

impl Base {
    /// Spans the base from the voxel at `from` to the one at a pixel, in the plane of the face. Returns `None` if the
    /// pixel does not show the plane.
    pub fn new(view: &DrawView, from: &SurfacePoint, at: Vec2) -> Option<Base> {
        let SurfacePoint { point, face } = *from;
        let axis = face.abs().max_position();
        let rays = &view.sight.rays;
        let direction = rays.direction_at(at.x, at.y);
        let t = (point[axis] - rays.origin[axis]) / direction[axis];
        if !(t.is_finite() && t > 0.0) {
            return None;
        }
        let dims = view.dims.as_vec3();
        let met = rays.origin + direction * t;
        let voxel = |p: Vec3| p.floor().clamp(Vec3::ZERO, dims - 1.0);
        let (a, b) = (voxel(point), voxel(met));
        let (mut low, mut high) = (a.min(b), a.max(b) + 1.0);
        let plane = point[axis].round();
        (low[axis], high[axis]) = (plane, plane);
        // The plane's horizon would be far beyond every grid.
        let mut end = met.clamp(-dims, 2.0 * dims);
        end[axis] = plane;
        Some(Base { low, high, face, end })
    }

    /// Returns the index of the axis of the face.
    fn axis(&self) -> usize {
        self.face.abs().max_position()
    }

    /// Returns the corners of the box that extends so many voxels out of the face, or into it if negative.
    pub fn raised(&self, layers: f32) -> [Vec3; 2] {
        let axis = self.axis();
        let Base { mut low, mut high, .. } = *self;
        let end = low[axis] + self.face[axis].signum() * layers;
        (low[axis], high[axis]) = (low[axis].min(end), low[axis].max(end));
        [low, high]
    }

    /// Returns the height for a pixel, in voxels out of the face (negative: into it), within the grid. It is where the
    /// normal through the end of the base's drag appears nearest to the pixel, so that the edge stays under the
    /// pointer. If the normal nearly points at the eye, it is the pixel's distance above or below that end. Returns
    /// `None` behind the eye.
    pub fn layers_at(&self, view: &DrawView, at: Vec2) -> Option<i32> {
        let sight = &view.sight;
        let axis = self.axis();
        let (plane, size) = (self.low[axis] as i32, view.dims[axis] as i32);
        let (into, out) = match self.face[axis] > 0.0 {
            true => (plane, size - plane),
            false => (size - plane, plane),
        };
        let place = |layers: i32| self.end + self.face * layers as f32;
        let foot = sight.pixel_of(self.end)?;
        let voxels_a_pixel = sight.along(Vec3::AXES[axis], 1.0, self.end);
        let seen = sight.pixel_of(place(1))?.distance(foot) * voxels_a_pixel;
        if seen < LEAST_SEEN {
            return Some((((foot.y - at.y) * voxels_a_pixel).round() as i32).clamp(-into, out));
        }
        let off = |layers: i32| Some((sight.pixel_of(place(layers))?.distance(at), layers));
        let nearest = (-into..=out).filter_map(off).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, layers)| layers)
    }
}

/// A box with a fixed base and a height that follows the pointer.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Raised {
    base: Base,
    /// Height out of the face, in voxels.
    layers: i32,
}

impl Raised {
    pub fn new(base: Base) -> Raised {
        Raised { base, layers: 0 }
    }

    /// Moves the pointer to a pixel of a view, which may differ from that of the base.
    pub fn lead(&mut self, view: &DrawView, at: Vec2) {
        self.layers = self.base.layers_at(view, at).unwrap_or(self.layers);
    }

    /// Returns its height in voxels out of the face, negative into it. It is never 0: at least one voxel on the
    /// intended side.
    pub fn layers(&self, outwards: bool) -> i32 {
        match self.layers {
            0 if outwards => 1,
            0 => -1,
            layers => layers,
        }
    }

    /// Returns its lowest and its highest corner.
    pub fn corners(&self, outwards: bool) -> [Vec3; 2] {
        self.base.raised(self.layers(outwards) as f32)
    }
}

/// Returns the lowest and the highest corner of the box on a base, `height` (in units of the smallest edge of a voxel)
/// outwards or inwards.
pub fn corners(view: &DrawView, base: &Base, height: f32, outwards: bool) -> [Vec3; 2] {
    let layers = (height / view.edges[base.axis()]).round().max(1.0);
    base.raised(if outwards { layers } else { -layers })
}

/// Returns the cuboid between two corners. `edges`: edges of a voxel in units of the smallest.
pub fn cuboid(edges: Vec3, [low, high]: [Vec3; 2]) -> Primitive {
    Primitive {
        solid: Solid::Cuboid,
        centre_vx: (low + high) * 0.5,
        half: (high - low) * 0.5 * edges,
        rotation: Quat::IDENTITY,
    }
}

/// Returns the twelve edges of the box between two corners.
pub fn edges_of([low, high]: [Vec3; 2]) -> Vec<[Vec3; 2]> {
    let corner = |i: u32| {
        let pick = |bit: u32, axis: usize| if i >> bit & 1 == 0 { low[axis] } else { high[axis] };
        Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    let pairs = (0..8).flat_map(|i| (0..3).map(move |bit| (i, i | 1 << bit)));
    pairs.filter(|(a, b)| a != b).map(|(a, b)| [corner(a), corner(b)]).collect()
}

/// Returns the wall of the grid's box seen from inside at a pixel, with its inward face; `None` beside it.
pub fn far_wall(view: &DrawView, at: Vec2) -> Option<SurfacePoint> {
    let rays = &view.sight.rays;
    let direction = rays.direction_at(at.x, at.y);
    let ends = [-rays.origin / direction, (view.dims.as_vec3() - rays.origin) / direction];
    let (enter, leave) = (ends[0].min(ends[1]).max_element(), ends[0].max(ends[1]));
    let axis = leave.min_position();
    let leave = leave[axis];
    (leave.is_finite() && leave > enter.max(0.0)).then(|| {
        let mut point = (rays.origin + direction * leave).clamp(Vec3::ZERO, view.dims.as_vec3());
        point[axis] = point[axis].round();
        SurfacePoint { point, face: Vec3::AXES[axis] * -direction[axis].signum() }
    })
}

#[cfg(test)]
mod tests {
    use super::super::view::tests::views;
    use super::*;

    #[test]
    fn the_base_is_what_is_dragged_over_and_the_height_goes_out_of_the_face() {
        for view in views() {
            let middle = view.sight.pixel_of(view.middle()).unwrap();
            let wall = far_wall(&view, middle).unwrap();
            let axis = wall.face.abs().max_position();
            let dims = view.dims.as_vec3();
            assert!(wall.point[axis] == 0.0 || wall.point[axis] == dims[axis]);
            let inside = wall.point + wall.face;
            assert!(inside.cmpge(Vec3::ZERO).all() && inside.cmple(dims).all(), "{inside}");

            // To a place in the same plane, three voxels further.
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut other = wall.point;
            other[u] = if other[u] > 0.5 * dims[u] { other[u] - 3.0 } else { other[u] + 3.0 };
            other[v] = if other[v] > 0.5 * dims[v] { other[v] - 2.0 } else { other[v] + 2.0 };
            let at = view.sight.pixel_of(other).unwrap();
            let height = 5.0 * view.edges[axis];
            let base = Base::new(&view, &wall, at).unwrap();
            let [low, high] = corners(&view, &base, height, true);
            let size = high - low;
            assert!((size[u] - 4.0).abs() <= 1.0 && (size[v] - 3.0).abs() <= 1.0, "{size}");
            assert_eq!(size[axis], 5.0);
            assert!(low.cmpge(Vec3::ZERO).all() && high.cmple(dims).all());
            let primitive = cuboid(view.edges, [low, high]);
            primitive.check().unwrap();
            assert_eq!(primitive.half * 2.0 / view.edges, size);
            // Inwards it lies behind the wall.
            let [low, high] = corners(&view, &base, height, false);
            assert!(low[axis] < 0.0 || high[axis] > dims[axis]);
        }
    }

    #[test]
    fn a_click_is_one_voxel_wide_and_the_base_ends_with_the_grid() {
        let view = &views()[0];
        let from = SurfacePoint { point: Vec3::new(30.5, 20.5, 50.0), face: Vec3::Z };
        let at = view.sight.pixel_of(from.point).unwrap();
        let base = |at| Base::new(view, &from, at).unwrap();
        let [low, high] = corners(view, &base(at + 0.01), 0.0, true);
        assert_eq!(high - low, Vec3::ONE);
        let [_, high] = corners(view, &base(Vec2::new(1e6, -1e6)), 1.0, true);
        assert_eq!(high.truncate(), view.dims.as_vec3().truncate());
        assert_eq!(far_wall(view, Vec2::new(-1e4, 0.0)), None);
    }

    /// Returns a base on each clearly visible face, from its middle outwards.
    fn bases(view: &DrawView) -> Vec<Base> {
        let faces = Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let near = |face: &Vec3| -view.direction(view.sight.rays.size.as_vec2() * 0.5).dot(*face);
        let base = |face: Vec3| {
            let middle = view.middle().round() + 0.5 * (Vec3::ONE - face.abs());
            let from = SurfacePoint { point: middle, face };
            let beside = middle + 3.0 * (Vec3::ONE - face.abs());
            Base::new(view, &from, view.sight.pixel_of(beside).unwrap())
        };
        faces.filter(|face| near(face) > 0.1).filter_map(base).collect()
    }

    #[test]
    fn the_height_is_where_the_normal_is_seen_nearest_to_the_pointer() {
        let mut led = 0;
        for view in views() {
            for base in bases(&view) {
                let foot = view.sight.pixel_of(base.end).unwrap();
                assert_eq!(base.layers_at(&view, foot), Some(0), "no leap after the base");
                let step = view.sight.pixel_of(base.end + base.face).unwrap() - foot;
                let seen = view.sight.along(Vec3::AXES[base.axis()], 1.0, base.end);
                if step.length() * seen < LEAST_SEEN {
                    continue;
                }
                led += 1;
                for layers in [-7, -1, 4, 9] {
                    let top = view.sight.pixel_of(base.end + base.face * layers as f32).unwrap();
                    assert_eq!(base.layers_at(&view, top), Some(layers));
                    // Movements across the normal have no effect.
                    let aside = step.perp().normalize() * 3.0;
                    let near = base.layers_at(&view, top + aside).unwrap();
                    assert!((near - layers).abs() <= 1, "{near} {layers}");
                }
                // It ends with the grid, however far the pointer goes.
                for far in [1e3, -1e3, 1e6, -1e6] {
                    let layers = base.layers_at(&view, foot + step * far).unwrap();
                    let [low, high] = base.raised(layers as f32);
                    let dims = view.dims.as_vec3();
                    assert!(low.cmpge(Vec3::ZERO).all() && high.cmple(dims).all());
                    assert!(layers.abs() > 9 && (layers > 0) == (far > 0.0), "{layers} {far}");
                }
            }
        }
        assert!(led > 5, "{led}");
    }

    #[test]
    fn a_normal_that_points_at_the_eye_is_followed_by_going_up_and_down() {
        let view = &views()[0];
        let from = SurfacePoint { point: Vec3::new(30.5, 20.5, 30.0), face: Vec3::Z };
        let base = Base::new(view, &from, view.sight.pixel_of(from.point).unwrap()).unwrap();
        let foot = view.sight.pixel_of(base.end).unwrap();
        let voxel_px = 1.0 / view.sight.along(Vec3::Z, 1.0, base.end);
        let at = |layers: f32| base.layers_at(view, foot - Vec2::Y * layers * voxel_px);
        assert_eq!([at(0.0), at(6.0), at(-6.0)], [Some(0), Some(6), Some(-6)]);
        assert_eq!([at(1e9), at(-1e9)], [Some(20), Some(-30)], "as far as the grid");
        assert_eq!(base.layers_at(view, Vec2::NAN), Some(0));
    }

    #[test]
    fn a_raised_box_is_never_flat() {
        let view = &views()[0];
        let from = SurfacePoint { point: Vec3::new(30.5, 20.5, 30.0), face: Vec3::Z };
        let at = view.sight.pixel_of(from.point).unwrap();
        let mut raised = Raised::new(Base::new(view, &from, at).unwrap());
        assert_eq!((raised.layers(true), raised.layers(false)), (1, -1));
        let [low, high] = raised.corners(false);
        assert_eq!((low.z, high.z), (29.0, 30.0));
        raised.lead(view, at - Vec2::Y * 10.0);
        assert!(raised.layers(true) > 1 && raised.layers(true) == raised.layers(false));
    }
}

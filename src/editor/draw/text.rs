//! Letters on a surface: their positions, and their solids.
//!
//! One [`DrawnSolid::Extrusion`] per letter, as deep into the surface as out of it. On a flat surface all letters share
//! a plane. On a curved one the line bends with it from its middle on, and each letter has a plane of its own. Letters
//! beyond the surface are reported.

use std::sync::Arc;

use glam::{Mat3, Quat, Vec2, Vec3};

use super::glyphs::Letter;
use super::view::DrawView;
use crate::editor::surface_guide::normal_around;
use crate::sculpture::Grid;
use crate::surface::raycast;
use crate::tools::drawn::{DrawnSolid, Extrusion, SolidPose};

/// Cosine of 8 degrees: a normal that near to a grid axis is snapped to it.
const NEARLY: f32 = 0.99;
/// Radius around a letter in which the surface defines its normal, in units of the smallest edge of a voxel.
pub const GROUND: f32 = 4.0;

/// The plane of a line of text: its middle, and the directions along it, up, and out of the surface.
#[derive(Clone, Copy, Debug)]
pub struct TextFrame {
    /// In voxels.
    at_vx: Vec3,
    /// Orthogonal unit axes, in units of the smallest edge of a voxel.
    axes: Mat3,
}

impl TextFrame {
    /// Places a line on a surface at `at_vx` with the normal `normal` (in units of the smallest edge; zero: towards the
    /// viewer). The letters are upright along the grid axis that points up in the picture, if the surface allows it.
    pub fn new(view: &DrawView, at_vx: Vec3, normal: Vec3) -> Option<TextFrame> {
        let axes = view.sight.screen_axes();
        let normal = normal.try_normalize().unwrap_or(axes.near);
        let along = normal.abs().max_position();
        let normal = match normal.abs()[along] > NEARLY {
            true => Vec3::AXES[along] * normal[along].signum(),
            false => normal,
        };
        let [_, picture_up, _] = view.frame(view.sight.pixel_of(at_vx)?)?;
        let upright = |axis: Vec3| {
            let flat = axis - normal * axis.dot(normal);
            (flat.length() > 0.5).then(|| flat.normalize())
        };
        let all = Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let up = all
            .filter_map(upright)
            .max_by(|a, b| a.dot(picture_up).total_cmp(&b.dot(picture_up)))?;
        let right = up.cross(normal).try_normalize()?;
        Some(TextFrame { at_vx, axes: Mat3::from_cols(right, up, normal) })
    }

    /// Returns the position in voxels of a point of the plane (units of the smallest edge).
    fn place(&self, p: Vec2, edges: Vec3) -> Vec3 {
        self.at_vx + self.axes * p.extend(0.0) / edges
    }

    /// Returns the plane of a letter `by` farther along the line, on the surface of `grid` within `reach` of this plane
    /// (units of the smallest edge); `None` if there is none.
    fn along(&self, grid: &Grid, by: f32, reach: f32) -> Option<TextFrame> {
        let edges = grid.voxel_size() / grid.voxel_size().min_element();
        let normal = self.axes.z_axis;
        let over = self.place(Vec2::new(by, 0.0), edges) + normal * reach / edges;
        let hit = raycast::cast(grid, over, -normal / edges)?;
        // If the ray begins in clay, the surface is out of reach.
        if !(hit.t > 0.0 && hit.t <= 2.0 * reach) {
            return None;
        }
        let at_vx = over - normal * hit.t / edges;
        let turned = normal_around(grid, at_vx, GROUND)?.try_normalize()?;
        let turn = Quat::from_rotation_arc(normal, turned);
        // Beyond an edge the surface faces another way.
        (turned.dot(normal) > 0.0)
            .then(|| TextFrame { at_vx, axes: Mat3::from_quat(turn) * self.axes })
    }

    /// Returns whether another plane on the same surface, `x` farther along the line, coincides with this one within
    /// the precision of voxels.
    fn has_in_plane(&self, other: &TextFrame, x: f32, edges: Vec3) -> bool {
        let off = (other.at_vx - self.place(Vec2::new(x, 0.0), edges)) * edges;
        off.length() < 1.0 && other.axes.z_axis.dot(self.axes.z_axis) > NEARLY
    }

    /// Returns the position of each letter of a line, with its own middle at the origin.
    fn of_letters(&self, grid: &Grid, letters: &[Letter]) -> Vec<PlacedLetter> {
        let edges = grid.voxel_size() / grid.voxel_size().min_element();
        let flat = |x: f32, floats: bool| PlacedLetter {
            stand: TextFrame { at_vx: self.place(Vec2::new(x, 0.0), edges), ..*self },
            floats,
        };
        let mut placed: Vec<PlacedLetter> = letters.iter().map(|l| flat(l.middle, false)).collect();
        // Without a surface in the middle, there is none to follow.
        if self.along(grid, 0.0, GROUND).is_none() {
            return placed;
        }
        let height = letters.iter().flat_map(|l| &l.outlines).flatten();
        let reach = height.map(|p| p.y.abs()).fold(GROUND, f32::max);
        for right in [true, false] {
            let side = |l: &Letter| if right { l.middle >= 0.0 } else { l.middle < 0.0 };
            let mut order: Vec<usize> = (0..letters.len()).filter(|i| side(&letters[*i])).collect();
            order.sort_by(|a, b| letters[*a].middle.abs().total_cmp(&letters[*b].middle.abs()));
            let (mut from, mut x) = (*self, 0.0);
            for i in order {
                let middle = letters[i].middle;
                let by = middle - x;
                match from.along(grid, by, reach) {
                    Some(stand) if self.has_in_plane(&stand, middle, edges) => {
                        from = flat(middle, false).stand;
                    }
                    Some(stand) => from = stand,
                    None => {
                        let at_vx = from.place(Vec2::new(by, 0.0), edges);
                        placed[i] =
                            PlacedLetter { stand: TextFrame { at_vx, ..from }, floats: true };
                        continue;
                    }
                }
                x = middle;
                placed[i] = PlacedLetter { stand: from, floats: false };
            }
        }
        placed
    }

    /// Returns the solids of letters that extend `depth` out of the surface, and as deep into it.
    pub fn solids(&self, grid: &Grid, letters: &[Letter], depth: f32) -> Vec<DrawnSolid> {
        let placed = self.of_letters(grid, letters);
        let solid = |(letter, placed): (&Letter, &PlacedLetter)| {
            let rotation = Quat::from_mat3(&placed.stand.axes).normalize();
            let outlines: Arc<[Arc<[Vec2]>]> =
                own(letter).map(|outline| outline.collect()).collect();
            let pose = SolidPose { at_vx: placed.stand.at_vx, rotation };
            Extrusion { pose, outlines, depth: 2.0 * depth }.into()
        };
        letters.iter().zip(&placed).map(solid).collect()
    }

    /// Returns the letters without a surface under them, in order.
    pub fn floating(&self, grid: &Grid, letters: &[Letter]) -> Vec<char> {
        let placed = self.of_letters(grid, letters);
        let floats = letters.iter().zip(&placed).filter(|(_, placed)| placed.floats);
        let mut signs: Vec<(f32, char)> = floats.map(|(l, _)| (l.middle, l.sign)).collect();
        signs.dedup();
        signs.into_iter().map(|(_, sign)| sign).collect()
    }

    /// Returns the outlines of the letters on the surface.
    pub fn sketch(&self, grid: &Grid, letters: &[Letter]) -> Vec<[Vec3; 2]> {
        let edges = grid.voxel_size() / grid.voxel_size().min_element();
        let placed = self.of_letters(grid, letters);
        let mut lines = Vec::new();
        for (letter, PlacedLetter { stand, .. }) in letters.iter().zip(&placed) {
            for outline in own(letter) {
                let places: Vec<Vec3> = outline.map(|p| stand.place(p, edges)).collect();
                let next = places.iter().cycle().skip(1);
                lines.extend(places.iter().zip(next).map(|(a, b)| [*a, *b]));
            }
        }
        lines
    }
}

/// The position of a letter, and whether there is nothing under it.
#[derive(Clone, Copy, Debug)]
struct PlacedLetter {
    stand: TextFrame,
    floats: bool,
}

/// Returns the outlines of a letter around its own middle.
fn own(letter: &Letter) -> impl Iterator<Item = impl Iterator<Item = Vec2>> {
    let middle = Vec2::new(letter.middle, 0.0);
    letter.outlines.iter().map(move |outline| outline.iter().map(move |p| *p - middle))
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::super::glyphs::{Font, letters};
    use super::super::view::tests::views;
    use super::*;

    fn empty(view: &DrawView) -> Grid {
        Grid::new(view.dims, view.edges, 1 << 30).unwrap()
    }

    fn grid(is: impl Fn(Vec3) -> bool) -> Grid {
        let mut grid = Grid::new(UVec3::splat(128), Vec3::ONE, 1 << 30).unwrap();
        for i in 0..128 * 128 * 128 {
            let v = grid.voxel_coords(i);
            grid.set(v.as_ivec3(), is(v.as_vec3() + 0.5));
        }
        grid
    }

    /// Returns a line along x in the plane of the front.
    fn before(at_vx: Vec3) -> TextFrame {
        TextFrame { at_vx, axes: Mat3::IDENTITY }
    }

    fn poses(solids: &[DrawnSolid]) -> Vec<SolidPose> {
        let pose = |solid: &DrawnSolid| match solid {
            DrawnSolid::Extrusion(Extrusion { pose, .. }) => *pose,
            _ => panic!("{solid:?}"),
        };
        solids.iter().map(pose).collect()
    }

    #[test]
    fn letters_stand_on_a_column_and_bend_with_it() {
        let radius = 30.0;
        let from_axis = |p: Vec3| (p - 64.0).with_y(0.0).length();
        let column = grid(|p| from_axis(p) < radius);
        let line = letters("COLUMN", Font::Bold, 14.0).unwrap();
        let stand = before(Vec3::new(64.0, 64.0, 64.0 + radius));
        let solids = stand.solids(&column, &line, 3.0);
        assert!(stand.floating(&column, &line).is_empty());
        let poses = poses(&solids);
        assert_eq!(poses.len(), 6);
        for (pose, letter) in poses.iter().zip(&line) {
            let away = from_axis(pose.at_vx);
            assert!((away - radius).abs() < 1.5, "{} is {away} from the axis", letter.sign);
            let normal = pose.rotation * Vec3::Z;
            let out = (pose.at_vx - 64.0).with_y(0.0).normalize();
            assert!(normal.dot(out) > 0.98, "{} looks along {normal}", letter.sign);
            // The distance around the column equals that along the line.
            let around = out.x.atan2(out.z) * radius;
            assert!((around - letter.middle).abs() < 5.0, "{around} for {}", letter.middle);
            assert!((pose.at_vx.y - 64.0).abs() < 1.5, "on the line");
        }
    }

    #[test]
    fn letters_on_a_flat_face_stand_in_its_plane_and_those_beyond_it_are_named() {
        let wall = grid(|p| p.z < 64.0 && p.x > 24.0);
        let stand = before(Vec3::new(64.0, 64.0, 64.0));
        let line = letters("Wall", Font::Light, 12.0).unwrap();
        for (pose, letter) in poses(&stand.solids(&wall, &line, 3.0)).iter().zip(&line) {
            assert_eq!(pose.at_vx, stand.at_vx + Vec3::X * letter.middle);
            assert_eq!(pose.rotation, Quat::IDENTITY);
        }
        assert!(stand.floating(&wall, &line).is_empty());
        // The dot of the first letter goes with its stroke.
        let long = letters("ijk and a wall", Font::Light, 12.0).unwrap();
        let floating = stand.floating(&wall, &long);
        assert!(floating.starts_with(&['i']) && floating.len() < 4, "{floating:?}");
        let flat = poses(&stand.solids(&wall, &long, 3.0));
        assert!(flat.iter().all(|pose| pose.at_vx.z == 64.0));
        // In the air all share a plane, and nothing is reported.
        let air = grid(|_| false);
        assert!(stand.floating(&air, &line).is_empty());
    }

    #[test]
    fn letters_can_be_read_from_the_viewer_on_every_face_that_is_seen() {
        let line = letters("Lä", Font::Light, 12.0).unwrap();
        for view in views() {
            let at = view.sight.pixel_of(view.middle()).unwrap();
            let near = -view.direction(at);
            for axis in Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                if axis.dot(near) < 0.3 {
                    continue;
                }
                // Nearly an axis becomes the axis.
                let stand = TextFrame::new(&view, view.middle(), axis + Vec3::ONE * 0.02).unwrap();
                assert!(stand.axes.z_axis.abs_diff_eq(axis, 1e-6));
                let solids = stand.solids(&empty(&view), &line, 3.0);
                solids.iter().for_each(|solid| solid.check().unwrap());
                let pixel =
                    |p: Vec3| view.sight.pixel_of(view.middle() + p / view.edges).unwrap() - at;
                let (right, up) = (pixel(stand.axes.x_axis * 5.0), pixel(stand.axes.y_axis * 5.0));
                assert!(right.perp_dot(up) < 0.0, "not mirrored");
                assert!(up.y < 0.0, "not upside down: {right} {up}");
            }
            let slanted = TextFrame::new(&view, view.middle(), Vec3::new(1.0, 0.3, 0.8)).unwrap();
            assert!((slanted.axes.determinant() - 1.0).abs() < 1e-4);
            assert_eq!(slanted.sketch(&empty(&view), &line).len(), {
                let outlines = line.iter().flat_map(|l| &l.outlines);
                outlines.map(Vec::len).sum::<usize>()
            });
        }
    }
}

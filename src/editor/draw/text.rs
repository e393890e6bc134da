//! Letters on a surface: where they stand, and the forms that they are.
//!
//! One [`Form::Extrusion`] a letter, as deep into the surface as out of it, so that letters on a curved one hang together
//! with it.

use std::sync::Arc;

use glam::{Mat3, Quat, Vec2, Vec3};

use super::glyphs::Letter;
use super::view::View;
use crate::tools::form::{Form, Pose};

/// A normal so near to an axis of the grid is meant to be that axis: the cosine of 8 degrees.
const NEARLY: f32 = 0.99;

/// Where a line of text stands: its middle, to the right along it, up, and out of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Stand {
    /// In voxels.
    at_vx: Vec3,
    /// Of length 1, at right angles, in units of the smallest edge of a voxel.
    axes: Mat3,
}

impl Stand {
    /// On a surface at `at_vx` that looks along `normal` (units of the smallest edge; zero: to the viewer). The letters
    /// stand upright as far as an axis of the grid that points up in the picture allows.
    pub fn new(view: &View, at_vx: Vec3, normal: Vec3) -> Option<Stand> {
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
        Some(Stand { at_vx, axes: Mat3::from_cols(right, up, normal) })
    }

    /// The solids of letters that reach `depth` out of the surface, and as deep into it.
    pub fn forms(&self, letters: &[Letter], depth: f32) -> Vec<Form> {
        let rotation = Quat::from_mat3(&self.axes).normalize();
        let pose = Pose { at_vx: self.at_vx, rotation };
        let outlines = |letter: &Letter| -> Arc<[Arc<[Vec2]>]> {
            letter.outlines.iter().map(|outline| Arc::from(&outline[..])).collect()
        };
        letters
            .iter()
            .map(|letter| Form::Extrusion { pose, outlines: outlines(letter), depth: 2.0 * depth })
            .collect()
    }

    /// The outlines of the letters on the surface.
    pub fn sketch(&self, view: &View, letters: &[Letter]) -> Vec<[Vec3; 2]> {
        let place = |p: Vec2| self.at_vx + self.axes * p.extend(0.0) / view.edges;
        let outlines = letters.iter().flat_map(|letter| &letter.outlines);
        outlines
            .flat_map(|outline| {
                let next = outline.iter().cycle().skip(1);
                outline.iter().zip(next).map(|(a, b)| [place(*a), place(*b)])
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::glyphs::{Font, letters};
    use super::super::view::tests::views;
    use super::*;

    #[test]
    fn letters_can_be_read_from_the_viewer_on_every_face_that_is_seen() {
        let line = letters("Lä", Font::Light, 12.0).unwrap();
        for view in views() {
            let at = view.sight.pixel_of(view.middle()).unwrap();
            let near = -view.way(at);
            for axis in Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                if axis.dot(near) < 0.3 {
                    continue;
                }
                // Nearly an axis is the axis.
                let stand = Stand::new(&view, view.middle(), axis + Vec3::ONE * 0.02).unwrap();
                assert!(stand.axes.z_axis.abs_diff_eq(axis, 1e-6));
                let forms = stand.forms(&line, 3.0);
                forms.iter().for_each(|form| form.check().unwrap());
                let pixel =
                    |p: Vec3| view.sight.pixel_of(view.middle() + p / view.edges).unwrap() - at;
                let (right, up) = (pixel(stand.axes.x_axis * 5.0), pixel(stand.axes.y_axis * 5.0));
                assert!(right.perp_dot(up) < 0.0, "not mirrored");
                assert!(up.y < 0.0, "not upside down: {right} {up}");
            }
            let slanted = Stand::new(&view, view.middle(), Vec3::new(1.0, 0.3, 0.8)).unwrap();
            assert!((slanted.axes.determinant() - 1.0).abs() < 1e-4);
            assert_eq!(slanted.sketch(&view, &line).len(), {
                let outlines = line.iter().flat_map(|l| &l.outlines);
                outlines.map(Vec::len).sum::<usize>()
            });
        }
    }
}

//! The voxels that rays meet.

use super::matrix::{Vector, minus};
use super::model::Model;
use super::statement::Ray;
use super::symmetry::is_along_axis;

/// Distance in voxels from a border below which rounding decides what a ray passes.
const NEAR: f64 = 1e-3;

impl Ray {
    /// Returns the eye, 100 voxels in front of the grid.
    pub fn eye(&self) -> Vector {
        let mut eye = self.through.map(|v| v as f64 + 0.5);
        eye[self.axis] = if self.rising { -100.0 } else { 160.0 };
        eye
    }

    pub fn aim(&self) -> Vector {
        let mut aim = [0.0; 3];
        aim[self.axis] = if self.rising { 1.0 } else { -1.0 };
        aim
    }

    /// Returns the same ray, moved by `by` voxels.
    pub fn shifted(&self, by: [i64; 3]) -> Ray {
        Ray { through: std::array::from_fn(|i| self.through[i] + by[i]), ..*self }
    }
}

/// Returns the interval in which a ray is within a slab. A parallel ray is never or always inside; if it runs along the
/// border, the end is NaN.
fn within(eye: f64, aim: f64, slab: i64) -> (f64, f64) {
    let (low, high) = (slab as f64 - eye, (slab + 1) as f64 - eye);
    match aim.abs() < 1e-9 {
        // The depth inside the slab.
        true => match (-low).min(high) {
            inside if inside >= NEAR => (f64::NEG_INFINITY, f64::INFINITY),
            // Along the border: for no relevant interval.
            inside if inside > -NEAR => (f64::NEG_INFINITY, f64::NAN),
            _ => (f64::INFINITY, f64::NEG_INFINITY),
        },
        false => {
            let (a, b) = (low / aim, high / aim);
            (a.min(b), a.max(b))
        }
    }
}

impl Model {
    /// Returns the images of a ray: their eyes and directions in voxels.
    fn image_rays(&self, ray: &Ray) -> Vec<(Vector, Vector)> {
        let (eye, aim) = (ray.eye(), ray.aim());
        let ahead = std::array::from_fn(|i| eye[i] + aim[i]);
        let of_image = |image: &super::symmetry::Image| {
            let from = image.point(eye);
            (from, minus(image.point(ahead), from))
        };
        self.images().iter().map(of_image).collect()
    }

    /// Returns the first voxel that each image of the ray meets; `None` if rounding decides which.
    pub fn met(&self, ray: &Ray) -> Option<Vec<[i64; 3]>> {
        let mut all = Vec::new();
        for (eye, aim) in self.image_rays(ray) {
            // The first voxel that it passes through, and the first that it may touch.
            let (mut first, mut touched) = ((f64::INFINITY, None), f64::INFINITY);
            for v in self.now.all().filter(|v| self.now.get(*v).is_some()) {
                let slabs = [0, 1, 2].map(|i| within(eye[i], aim[i], v[i]));
                let enters = slabs.iter().map(|s| s.0).fold(f64::NEG_INFINITY, f64::max);
                let leaves = slabs.iter().map(|s| s.1).fold(f64::INFINITY, f64::min);
                let touches = slabs.iter().any(|s| s.1.is_nan());
                let long = (leaves - enters) * aim.iter().map(|a| a.abs()).fold(0.0, f64::max);
                if long > NEAR && !touches && enters > NEAR {
                    if enters < first.0 {
                        first = (enters, Some(v));
                    }
                } else if long > -NEAR && leaves > 0.0 {
                    touched = touched.min(enters);
                }
            }
            if touched < first.0 + NEAR {
                return None;
            }
            all.extend(first.1);
        }
        Some(all)
    }

    /// Returns whether it is certain what all images of the ray meet, whatever the sculpture.
    pub fn is_clear(&self, ray: &Ray) -> bool {
        let dims = self.now.dims.map(|d| d as f64);
        let clear = |eye: f64| (eye - eye.round()).abs() >= 2.0 * NEAR;
        self.image_rays(ray).iter().all(|(eye, aim)| {
            is_along_axis(*aim)
                && (0..3).all(|i| aim[i].abs() > 1e-9 || clear(eye[i]))
                && (0..3).any(|i| eye[i] < -1.0 || eye[i] > dims[i] + 1.0)
        })
    }
}

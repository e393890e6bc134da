//! The lens of a camera: projection of rays to pixels and back, with the Brown-Conrady distortion
//! of OpenCV's `calibrateCamera`.
//!
//! A ray is (x, y) at depth 1 in front of the camera, x to the right, y down. Pixel positions are
//! OpenCV's: integers are pixel centres, (0, 0) that of the upper left one.

use glam::{DMat2, DVec2, Vec2};
use serde::Deserialize;
use thiserror::Error;

use crate::view::eye::Frustum;

/// The reason why a lens cannot be used.
#[derive(Debug, Error)]
pub enum IntrinsicsError {
    #[error("the camera's lens: {0}")]
    Parse(#[from] Box<toml::de::Error>),
    #[error("the camera's lens: {0}")]
    Value(String),
}

/// A calibrated lens. Focal lengths and centre in pixels of a picture of `width` x `height`.
#[derive(Clone, Copy, PartialEq, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intrinsics {
    pub width: u32,
    pub height: u32,
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
    /// Radial distortion.
    #[serde(default)]
    pub k1: f64,
    #[serde(default)]
    pub k2: f64,
    /// Tangential distortion.
    #[serde(default)]
    pub p1: f64,
    #[serde(default)]
    pub p2: f64,
    /// Radial distortion; OpenCV prints it after the tangential one.
    #[serde(default)]
    pub k3: f64,
}

/// Largest number of Newton steps; four are enough for typical lenses.
const MAX_STEPS: usize = 30;
/// Largest number of halvings of a step.
const MAX_HALVINGS: usize = 20;
/// Least determinant of the derivative of the distortion: below it, the picture counts as folded.
const LEAST_DETERMINANT: f64 = 1e-3;
/// Tolerance of an inverted position, in pixels.
const TOLERANCE_PX: f64 = 1e-6;

impl Intrinsics {
    /// Reads the fields from TOML and checks them.
    pub fn parse(toml: &str) -> Result<Intrinsics, IntrinsicsError> {
        let intrinsics: Intrinsics = toml::from_str(toml).map_err(Box::new)?;
        intrinsics.check()?;
        Ok(intrinsics)
    }

    /// Returns a lens without distortion, with its axis in the centre, from the vertical field of view.
    pub fn pinhole(width: u32, height: u32, fov_y_rad: f64) -> Intrinsics {
        let (w, h) = (f64::from(width), f64::from(height));
        let focal = 0.5 * h / (0.5 * fov_y_rad).tan();
        let (cx, cy) = (0.5 * (w - 1.0), 0.5 * (h - 1.0));
        let (fx, fy) = (focal, focal);
        Intrinsics { width, height, fx, fy, cx, cy, k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 }
    }

    /// Refuses values that no lens has, and a distortion that folds the picture over itself.
    ///
    /// After this, [`Intrinsics::ray_from_pixel`] has a result everywhere in the picture.
    pub fn check(&self) -> Result<(), IntrinsicsError> {
        let refuse = |problem: String| Err(IntrinsicsError::Value(problem));
        let Intrinsics { width, height, fx, fy, cx, cy, k1, k2, p1, p2, k3 } = *self;
        if width == 0 || height == 0 {
            return refuse(format!("a picture of {width} x {height}"));
        }
        if ![fx, fy, cx, cy, k1, k2, p1, p2, k3].iter().all(|value| value.is_finite()) {
            return refuse("a value is not a finite number".into());
        }
        let (w, h) = (f64::from(width), f64::from(height));
        let longest = w.max(h);
        for (name, focal) in [("fx", fx), ("fy", fy)] {
            if !(0.05 * longest..=100.0 * longest).contains(&focal) {
                return refuse(format!("{name} = {focal} pixels for a picture of {w} x {h}"));
            }
        }
        if !(0.0..=w).contains(&cx) || !(0.0..=h).contains(&cy) {
            return refuse(format!("the centre ({cx}, {cy}) lies outside {w} x {h}"));
        }
        const CELLS: u32 = 32;
        for row in 0..=CELLS {
            for column in 0..=CELLS {
                let share = DVec2::new(f64::from(column), f64::from(row)) / f64::from(CELLS);
                let pixel = share * DVec2::new(w, h) - 0.5;
                if self.ray_from_pixel(pixel).is_none() {
                    let (x, y) = (pixel.x, pixel.y);
                    return refuse(format!("the distortion folds the picture at ({x:.0}, {y:.0})"));
                }
            }
        }
        Ok(())
    }

    /// Returns the pixel of a ray.
    pub fn pixel_from_ray(&self, ray: DVec2) -> DVec2 {
        let (distorted, _) = self.distort(ray);
        distorted * DVec2::new(self.fx, self.fy) + DVec2::new(self.cx, self.cy)
    }

    /// Returns the ray of a pixel: its undistorted position; `None` where the lens sends no light, which
    /// [`Intrinsics::check`] excludes within the picture.
    pub fn ray_from_pixel(&self, pixel: DVec2) -> Option<DVec2> {
        let focal = DVec2::new(self.fx, self.fy);
        let target = (pixel - DVec2::new(self.cx, self.cy)) / focal;
        // Along the line from the centre to the target, each step starting where the last one
        // ended, so that the solution is on this side of any fold.
        const STAGES: u32 = 8;
        let mut ray = DVec2::ZERO;
        for stage in 1..=STAGES {
            let aim = target * (f64::from(stage) / f64::from(STAGES));
            ray = self.invert(aim, ray, TOLERANCE_PX / focal.max_element())?;
        }
        Some(ray)
    }

    /// Solves `distort(ray) = aim` by Newton's method. Where the distortion hardly grows, a whole step may lead far
    /// beyond the solution and over a fold; steps are halved until they lead nearer to it on this side.
    fn invert(&self, aim: DVec2, start: DVec2, tolerance: f64) -> Option<DVec2> {
        // The error at a ray and the derivative there; `None` beyond a fold.
        let at = |ray: DVec2| {
            let (distorted, change) = self.distort(ray);
            (change.determinant() > LEAST_DETERMINANT).then_some((distorted - aim, change))
        };
        let mut ray = start;
        let (mut error, mut change) = at(ray)?;
        for _ in 0..MAX_STEPS {
            if error.length() <= tolerance {
                return Some(ray);
            }
            let mut step = change.inverse() * error;
            let mut halvings = 0..MAX_HALVINGS;
            (error, change) = loop {
                match at(ray - step) {
                    Some(next) if next.0.length() < error.length() => break next,
                    _ => halvings.next()?,
                };
                step *= 0.5;
            };
            ray -= step;
        }
        None
    }

    /// Returns the distorted position of a ray and its derivative.
    fn distort(&self, ray: DVec2) -> (DVec2, DMat2) {
        let Intrinsics { k1, k2, p1, p2, k3, .. } = *self;
        let (x, y) = (ray.x, ray.y);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        // d(radial) / d(r2), twice for d(r2) / dx = 2x.
        let slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));
        let tangential = DVec2::new(
            2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        );
        let mixed = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
        let change = DMat2::from_cols(
            DVec2::new(radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x, mixed),
            DVec2::new(mixed, radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x),
        );
        (ray * radial + tangential, change)
    }

    /// Returns the texture position of a ray, 0 to 1 from the upper left corner.
    pub fn uv_from_ray(&self, ray: DVec2) -> DVec2 {
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        (self.pixel_from_ray(ray) + 0.5) / size
    }

    /// Returns the texture position for each pixel of an undistorted picture (this lens with k and p zero, scaled to
    /// `width` x `height`), row by row. Positions outside 0 to 1 are beyond the camera's picture.
    pub fn undistort_map(&self, width: u32, height: u32) -> Vec<Vec2> {
        let ideal = self.scaled(width, height);
        let (focal, centre) = (DVec2::new(ideal.fx, ideal.fy), DVec2::new(ideal.cx, ideal.cy));
        let positions = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        positions
            .map(|(x, y)| {
                let pixel = DVec2::new(f64::from(x), f64::from(y));
                self.uv_from_ray((pixel - centre) / focal).as_vec2()
            })
            .collect()
    }

    /// Returns the lens for a picture of another size. Only valid if the camera scales its picture and does not crop
    /// it.
    pub fn scaled(&self, width: u32, height: u32) -> Intrinsics {
        let x = f64::from(width) / f64::from(self.width.max(1));
        let y = f64::from(height) / f64::from(self.height.max(1));
        Intrinsics {
            width,
            height,
            fx: self.fx * x,
            fy: self.fy * y,
            // Scaled about the corner of the picture, half a pixel from the first centre.
            cx: (self.cx + 0.5) * x - 0.5,
            cy: (self.cy + 0.5) * y - 0.5,
            ..*self
        }
    }

    /// Returns the frustum of the undistorted picture, for the projection of an eye that matches the camera.
    pub fn frustum(&self) -> Frustum {
        let (w, h) = (f64::from(self.width), f64::from(self.height));
        let (x, y) = (self.cx + 0.5, self.cy + 0.5);
        Frustum {
            left: (-x / self.fx) as f32,
            right: ((w - x) / self.fx) as f32,
            down: (-(h - y) / self.fy) as f32,
            up: (y / self.fy) as f32,
        }
    }
}

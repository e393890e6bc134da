//! Detection: from a picture to the markers in it.

use glam::{DMat3, DVec2};

use super::family::{self, CELLS, CODE_CELLS};
use super::grey::Grey;
use super::{contour, homography, quad};
use crate::video::Intrinsics;

/// A detected marker.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sighting {
    pub id: u32,
    /// Outer corners of the black rim as undistorted rays at depth 1 (x right, y down): upper left,
    /// upper right, lower right, lower left of the upright marker.
    pub corners: [DVec2; 4],
    /// Number of corrected cells of the code.
    pub wrong: u32,
}

/// Least difference of a pixel of the rim from its surroundings, of 255.
const MARGIN: u32 = 6;
/// Least contrast between the paper and the rim.
const LEAST_CONTRAST: f64 = 20.0;
/// Most cells of the rim that may look white, such as in a glint.
const MAX_RIM_WRONG: usize = 2;

/// Returns the markers of the family in a picture; of equal numbers, the largest. `lens` is that of the camera; it is
/// scaled to the size of the picture.
pub fn detect(grey: &Grey, lens: &Intrinsics) -> Vec<Sighting> {
    let (Ok(width), Ok(height)) = (u32::try_from(grey.width), u32::try_from(grey.height)) else {
        return Vec::new();
    };
    if width < 16 || height < 16 {
        return Vec::new();
    }
    let lens = lens.scaled(width, height);
    let reach = (grey.width.max(grey.height) / 40).max(6);
    let dark = grey.blurred().dark(reach, MARGIN);
    let shortest = (4.0 * quad::SHORTEST_SIDE_PX * 0.7) as usize;
    let mut found: Vec<(f64, Sighting)> = Vec::new();
    for outline in contour::outlines(&dark, grey.width, grey.height, shortest) {
        let Some(corners_px) = quad::corners(&outline) else { continue };
        let Some(rays) = quad::refine(grey, &lens, corners_px) else { continue };
        let Some(sighting) = read(grey, &lens, rays) else { continue };
        let [a, b, c, d] = sighting.corners;
        let area = (c - a).perp_dot(d - b).abs();
        match found.iter_mut().find(|(_, other)| other.id == sighting.id) {
            Some(other) if other.0 < area => *other = (area, sighting),
            Some(_) => {}
            None => found.push((area, sighting)),
        }
    }
    found.into_iter().map(|(_, sighting)| sighting).collect()
}

/// Decodes a square, if it is a marker. `corners` clockwise as seen.
fn read(grey: &Grey, lens: &Intrinsics, corners: [DVec2; 4]) -> Option<Sighting> {
    let map = homography::from_square(&corners)?;
    // The rim and the paper around it define black and white; illumination may be uneven.
    let last = CELLS as i32;
    let mut black = Plane::default();
    let mut white = Plane::default();
    let mut rim = Vec::with_capacity(4 * (CELLS - 1));
    for y in -1..=last {
        for x in -1..=last {
            let in_rim = (x == 0 || y == 0 || x == last - 1 || y == last - 1)
                && (0..last).contains(&x)
                && (0..last).contains(&y);
            let on_paper = x == -1 || y == -1 || x == last || y == last;
            if in_rim {
                let value = cell(grey, lens, &map, x, y);
                black.add(place(x, y), value);
                rim.push((place(x, y), value));
            } else if on_paper {
                white.add(place(x, y), cell(grey, lens, &map, x, y));
            }
        }
    }
    let (black, white) = (black.fit()?, white.fit()?);
    let limit = |at: DVec2| 0.5 * (black.at(at) + white.at(at));
    let contrast = white.at(DVec2::ZERO) - black.at(DVec2::ZERO);
    let bright_rim = rim.iter().filter(|(at, value)| *value > limit(*at)).count();
    if contrast.is_nan() || contrast < LEAST_CONTRAST || bright_rim > MAX_RIM_WRONG {
        return None;
    }
    let mut pattern = 0u64;
    for y in 1..=CODE_CELLS as i32 {
        for x in 1..=CODE_CELLS as i32 {
            let bright = cell(grey, lens, &map, x, y) > limit(place(x, y));
            pattern = pattern << 1 | u64::from(bright);
        }
    }
    let reading = family::read(pattern)?;
    let upright = [0, 1, 2, 3].map(|i| corners[(i + reading.quarter_turns) % 4]);
    Some(Sighting { id: reading.id, corners: upright, wrong: reading.wrong })
}

/// Returns the centre of a cell in the square from -1 to 1.
fn place(x: i32, y: i32) -> DVec2 {
    (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * (2.0 / CELLS as f64) - 1.0
}

/// Returns the mean brightness around the centre of a cell.
fn cell(grey: &Grey, lens: &Intrinsics, map: &DMat3, x: i32, y: i32) -> f64 {
    const ASIDE: f64 = 0.2 * 2.0 / CELLS as f64;
    let middle = place(x, y);
    let spots = [(0.0, 0.0), (ASIDE, ASIDE), (-ASIDE, ASIDE), (ASIDE, -ASIDE), (-ASIDE, -ASIDE)];
    let sum: f64 = spots
        .iter()
        .map(|&(dx, dy)| homography::project(map, middle + DVec2::new(dx, dy)))
        .map(|ray| grey.at(lens.pixel_from_ray(ray)))
        .sum();
    sum / spots.len() as f64
}

/// Brightness as a plane over the marker, fitted by least squares to positions symmetric about the
/// centre.
#[derive(Clone, Copy, Default)]
struct Plane {
    count: f64,
    sum: f64,
    moment: DVec2,
    spread: DVec2,
}

impl Plane {
    fn add(&mut self, at: DVec2, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.moment += at * value;
        self.spread += at * at;
    }

    fn fit(self) -> Option<FittedPlane> {
        let fitted =
            FittedPlane { middle: self.sum / self.count, slope: self.moment / self.spread };
        fitted.slope.is_finite().then_some(fitted)
    }
}

struct FittedPlane {
    middle: f64,
    slope: DVec2,
}

impl FittedPlane {
    fn at(&self, place: DVec2) -> f64 {
        self.middle + self.slope.dot(place)
    }
}

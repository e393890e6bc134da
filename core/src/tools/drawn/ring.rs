//! Ring: a torus about its y axis.

use glam::{DVec2, DVec3};

use super::fields::{Field, SolidPose};
use super::frame::Frame;
use super::spec::{DrawnShape, DrawnSpec, Surface, coverage_of_distance};
use crate::sculpture::region::BoxCoverage;
use crate::tools::parallelepiped::Parallelepiped;

/// A torus about its y axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Ring {
    /// Its centre and axis.
    pub pose: SolidPose,
    /// Distance from the centre to the middle of the tube.
    pub radius: f32,
    /// Radius of the tube.
    pub tube: f32,
}

const RADII: &str = "both radii must be above zero and at most a million voxels";

impl DrawnShape for Ring {
    const SPEC: DrawnSpec = DrawnSpec {
        name: "ring",
        label: "ring",
        help: "a torus about y: the radius from its centre to the middle of the tube, and the radius of the tube",
        bench_row: "turned ring of radius 64 and 16",
        example: |pose, size| Ring { pose, radius: size, tube: 0.25 * size }.into(),
    };

    type Surface = Torus;

    fn fields(&mut self) -> Vec<Field<'_>> {
        let mut fields = Vec::from(self.pose.fields());
        fields.push(Field::length("radius", "R", RADII, &mut self.radius));
        fields.push(Field::length("tube", "R", RADII, &mut self.tube));
        fields
    }

    fn surface(&self, stretch: DVec3) -> Torus {
        Torus {
            frame: Frame::new(&self.pose, stretch),
            radius: f64::from(self.radius),
            tube: f64::from(self.tube),
        }
    }
}

/// A torus about the y axis of a frame.
#[derive(Clone, Debug)]
pub struct Torus {
    frame: Frame,
    radius: f64,
    tube: f64,
}

impl Surface for Torus {
    fn bounds(&self) -> [DVec3; 2] {
        let out = self.radius + self.tube;
        let reach = DVec3::new(out, self.tube, out);
        self.frame.bounds([-reach, reach])
    }

    fn longest(&self) -> f64 {
        self.frame.length() + self.radius + self.tube
    }

    #[inline]
    fn distance(&self, p: DVec3, _: &[u32]) -> f64 {
        let p = self.frame.around_y(p);
        (p.x - self.radius).hypot(p.y) - self.tube
    }

    fn coverage(&self, points: &Parallelepiped, margin: f64) -> BoxCoverage {
        let distance = self.distance(points.middle, &[]);
        let far = coverage_of_distance(distance, points.radius() + margin);
        if far != BoxCoverage::Part {
            return far;
        }
        // The tube is a disc in the half plane of distances from the axis and heights.
        let [low, high] = self.frame.local_box(points).around_y();
        let centre = DVec2::new(self.radius, 0.0);
        let furthest = (centre - low).abs().max((high - centre).abs()).length();
        match () {
            _ if centre.clamp(low, high).distance(centre) > self.tube + margin => BoxCoverage::None,
            _ if furthest < self.tube - margin => BoxCoverage::All,
            () => BoxCoverage::Part,
        }
    }
}

//! Lathe: a profile rotated about an axis.

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2};

use super::fields::{Field, FieldValue, SolidPose, require};
use super::frame::Frame;
use super::outline::{self, Outlines};
use super::spec::{DrawnShape, DrawnSpec, Surface, coverage_of_distance};
use crate::sculpture::region::BoxCoverage;
use crate::tools::parallelepiped::Parallelepiped;

/// A profile rotated about its y axis: points of distance from the axis and height. A straight line connects the first
/// and the last point with the axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Lathe {
    /// Its origin and axis.
    pub pose: SolidPose,
    /// The profile.
    pub profile: Arc<[Vec2]>,
}

impl DrawnShape for Lathe {
    const SPEC: DrawnSpec = DrawnSpec {
        name: "lathe",
        label: "lathe",
        help: "a profile revolved about y: distances from the axis and heights, connected to the axis at both ends",
        bench_row: "turned lathe of 33 points",
        example: |pose, size| Lathe { pose, profile: outline::wavy(size) }.into(),
    };

    type Surface = Turned;

    fn fields(&mut self) -> Vec<Field<'_>> {
        let mut fields = Vec::from(self.pose.fields());
        fields.push(Field {
            key: "profile",
            usage: "R,H;R,H;...",
            rule: "the profile has more than 1024 points",
            value: FieldValue::Outline(&mut self.profile),
        });
        fields
    }

    fn check(&self) -> Result<(), &'static str> {
        require(
            self.profile.iter().all(|point| point.x >= 0.0),
            "the profile must not cross its axis: distances are at least 0",
        )
    }

    fn surface(&self, stretch: DVec3) -> Turned {
        let points = outline::exact(&self.profile);
        let mut profile = Outlines::default();
        profile.join(&points);
        if let [first, .., last] = points[..] {
            profile.join(&[DVec2::new(0.0, first.y), first]);
            profile.join(&[last, DVec2::new(0.0, last.y)]);
        }
        Turned { frame: Frame::new(&self.pose, stretch), profile }
    }
}

/// A profile about the y axis of a frame.
#[derive(Clone, Debug)]
pub struct Turned {
    frame: Frame,
    profile: Outlines,
}

impl Surface for Turned {
    fn bounds(&self) -> [DVec3; 2] {
        let [low, high] = self.profile.bounds();
        let out = high.x;
        self.frame.bounds([DVec3::new(-out, low.y, -out), DVec3::new(out, high.y, out)])
    }

    fn longest(&self) -> f64 {
        let [low, high] = self.profile.bounds();
        self.frame.length() + low.length() + high.length()
    }

    #[inline]
    fn distance(&self, p: DVec3, _: &[u32]) -> f64 {
        self.profile.distance(self.frame.around_y(p))
    }

    fn coverage(&self, points: &Parallelepiped, margin: f64) -> BoxCoverage {
        let distance = self.distance(points.middle, &[]);
        let far = coverage_of_distance(distance, points.radius() + margin);
        if far != BoxCoverage::Part {
            return far;
        }
        let [low, high] = self.frame.local_box(points).around_y();
        let half = (high - low) * 0.5;
        let half_edges = [half.with_y(0.0), half.with_x(0.0)];
        self.profile.coverage((low + high) * 0.5, &half_edges, margin)
    }
}

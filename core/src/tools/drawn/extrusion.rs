//! Extrusion: outlines in a plane, extruded to both sides of it.

use std::sync::Arc;

use glam::{DVec3, Vec2};

use super::fields::{Field, FieldValue, SolidPose};
use super::frame::Frame;
use super::outline::{self, Outlines};
use super::spec::{DrawnShape, DrawnSpec, Surface};
use crate::sculpture::region::BoxCoverage;
use crate::tools::parallelepiped::Parallelepiped;

/// Outlines in the plane of its x and y axes, extruded by half of `depth` to both sides. A point is inside if an odd
/// number of outlines surrounds it, so that an outline within another is a hole.
#[derive(Clone, PartialEq, Debug)]
pub struct Extrusion {
    /// Its origin and axes.
    pub pose: SolidPose,
    /// The outlines, each closed from its last point to its first.
    pub outlines: Arc<[Arc<[Vec2]>]>,
    /// Its length along z.
    pub depth: f32,
}

impl DrawnShape for Extrusion {
    const SPEC: DrawnSpec = DrawnSpec {
        name: "extrusion",
        label: "extrusion",
        help: "an outline in x and y, extruded by half of the depth to each side; further outlines after `/` are holes where they lie inside another",
        bench_row: "turned extrusion of 33 points",
        example: |pose, size| {
            Extrusion { pose, outlines: Arc::new([outline::wavy(size)]), depth: size }.into()
        },
    };

    type Surface = Prism;

    fn fields(&mut self) -> Vec<Field<'_>> {
        let mut fields = Vec::from(self.pose.fields());
        fields.push(Field::length(
            "depth",
            "D",
            "the depth must be above zero and at most a million voxels",
            &mut self.depth,
        ));
        fields.push(Field {
            key: "outline",
            usage: "X,Y;X,Y;...[/X,Y;...]",
            rule: "the outlines have more than 1024 points",
            value: FieldValue::Outlines(&mut self.outlines),
        });
        fields
    }

    fn surface(&self, stretch: DVec3) -> Prism {
        let mut outlines = Outlines::default();
        self.outlines.iter().for_each(|points| outlines.close(&outline::exact(points)));
        let half_depth = f64::from(self.depth) * 0.5;
        Prism { frame: Frame::new(&self.pose, stretch), outlines, half_depth }
    }
}

/// Outlines in the plane of the x and y axes of a frame, extruded to both sides.
#[derive(Clone, Debug)]
pub struct Prism {
    frame: Frame,
    outlines: Outlines,
    half_depth: f64,
}

impl Surface for Prism {
    fn bounds(&self) -> [DVec3; 2] {
        let [low, high] = self.outlines.bounds();
        self.frame.bounds([low.extend(-self.half_depth), high.extend(self.half_depth)])
    }

    fn longest(&self) -> f64 {
        let [low, high] = self.outlines.bounds();
        self.frame.length() + low.length() + high.length() + self.half_depth
    }

    #[inline]
    fn distance(&self, p: DVec3, _: &[u32]) -> f64 {
        let p = self.frame.local(p);
        self.outlines.distance(p.truncate()).max(p.z.abs() - self.half_depth)
    }

    fn coverage(&self, points: &Parallelepiped, margin: f64) -> BoxCoverage {
        let points = self.frame.local_box(points);
        let (z, reach) = (points.middle.z.abs(), points.extent().z);
        let along = match () {
            _ if z + reach < self.half_depth - margin => BoxCoverage::All,
            _ if z - reach > self.half_depth + margin => return BoxCoverage::None,
            () => BoxCoverage::Part,
        };
        let half_edges = points.half_edges.map(DVec3::truncate);
        along.and(self.outlines.coverage(points.middle.truncate(), &half_edges, margin))
    }
}

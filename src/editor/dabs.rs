//! Strokes of the brushes that deform: the brush is used at a spacing along a path over the surface. Most move the surface
//! as it was when the stroke began, so that overlapping uses do not add up; pinch and smear move what uses before left.
//!
//! The plane of flatten, scrape and fill is that of the surface around the press, for the whole stroke; draw and crease go
//! along the normal of the surface around each use, as it was when the stroke began.

use glam::{IVec3, Vec2, Vec3};

use super::Editor;
use super::path::Path;
use super::pressure::{PenUse, touched};
use super::stroke::{LEAP, LOOK_EVERY_PX, MOST_LOOKS, Stroke, SurfaceGuide, Work};
use crate::command::Command;
use crate::input::pen::PenTouch;
use crate::picking::Picker;
use crate::sculpture::Grid;
use crate::tools::brush::BrushId;
use crate::tools::brush::dab::{Dab, DabPlace};
use crate::tools::brush::kernel::grab::{MAX_RADIUS, MIN_RADIUS};
use crate::tools::brush::keys::{RADIUS, STEADY};
use crate::tools::brush::options::BrushOptions;
use crate::tools::brush::spec::{BrushStroke, Inverse, SurfaceNormal};

/// Most steps along a radius in which the surface is looked at for its plane.
const STEPS: f32 = 10.0;

/// A brush at work.
pub(super) struct Dabs {
    options: BrushOptions,
    /// The lead of a pen over it, and how it touches now.
    pen: PenUse,
    touch: PenTouch,
    /// The modifier that inverts the tool was held at the press.
    inverse: bool,
    /// The pointer on the surface; none while something else moves the tool.
    guide: Option<SurfaceGuide>,
    /// Where the stroke began, in voxels, and the direction out of the surface there.
    start: Vec3,
    normal: Vec3,
    /// Where it was used last, in voxels.
    last: Vec3,
    /// Voxel edges in units of the smallest.
    edges: Vec3,
}

impl Dabs {
    /// Whether the pointer leads it.
    pub fn is_led(&self) -> bool {
        self.guide.is_some()
    }

    /// The options with which it is used now.
    fn in_use(&self) -> BrushOptions {
        let options = touched(&self.options, self.pen, self.touch);
        options.with(RADIUS, options.get(RADIUS).clamp(MIN_RADIUS, MAX_RADIUS))
    }

    /// The normal that it uses.
    fn normal_used(&self) -> SurfaceNormal {
        match self.options.brush().spec().stroke {
            BrushStroke::Surface { normal, .. } => normal,
            _ => SurfaceNormal::OfPress { on_plane: false },
        }
    }

    /// The brush that it is, or that the modifier makes of it, and the sense in which that works.
    fn brush_and_sense(&self) -> (BrushId, f32) {
        let brush = self.options.brush();
        match brush.spec().inverse {
            Inverse::Brush(other) if self.inverse => (other, 1.0),
            Inverse::Sense if self.inverse => (brush, -1.0),
            _ => (brush, 1.0),
        }
    }

    /// The use of the brush at a place, in voxels. None where it does nothing.
    fn command(&self, at: Vec3) -> Option<Command> {
        let (brush, sense) = self.brush_and_sense();
        let options = self.in_use().of(brush);
        let normal = self.normal;
        let above = ((at - self.start) * self.edges).dot(normal);
        let at_vx = match self.normal_used() {
            SurfaceNormal::OfPress { on_plane: true } => at - normal * above / self.edges,
            _ => at,
        };
        let (from_vx, edges) = (self.last, self.edges);
        let place = DabPlace::Surface { at_vx, from_vx, normal, edges, sense };
        (brush.spec().dab)(&Dab { options: &options, place }).map(Command::Brush)
    }
}

impl Editor {
    /// Opens a stroke of the brush in hand where the tool is, and uses it. `at`: the pointer that leads it (pixels).
    pub(super) fn begin_dabs(
        &mut self,
        brush: BrushId,
        inverse: bool,
        at: Option<Vec2>,
        picker: &Picker,
    ) {
        if !self.begin_brush(brush) {
            return;
        }
        let start = self.tool.centre_vx;
        let options = self.ball_options(brush);
        let radius = options.get(RADIUS);
        let grid = self.session.document().grid();
        let normal = normal_around(grid, start, radius)
            .or_else(|| at.map(|at| picker.normal(grid, at, true)))
            .and_then(Vec3::try_normalize)
            .unwrap_or(Vec3::Y);
        let guide = at.map(|at| SurfaceGuide::new(at, start, &self.tool, grid, picker));
        let edges = grid.voxel_size() / grid.voxel_size().min_element();
        let path = Path::new(start, (brush.spec().spacing * radius).max(1.0), edges);
        self.grip.begin();
        let (pen, touch) = (self.tool.pens.of_brush(brush), self.grip.now);
        let last = start;
        let dabs = Dabs { options, pen, touch, inverse, guide, start, normal, last, edges };
        self.stroke = Some(Stroke::new(Work::Dabs(dabs), path));
        self.dab_at(&[start]);
    }

    /// Leads the brush over the surface to a point of the picture.
    pub(super) fn lead_dabs(&mut self, to: Vec2, picker: &Picker) {
        let Some(Stroke { work: Work::Dabs(dabs), path, .. }) = &mut self.stroke else { return };
        let Some(guide) = dabs.guide.as_mut().filter(|_| to.is_finite()) else { return };
        let grid = self.session.document().grid();
        path.scale(dabs.pen.size(self.grip.now));
        let from = guide.at;
        let to = on_rope(from, to, dabs.options.get(STEADY));
        let looks = (to.distance(from) / LOOK_EVERY_PX).ceil().clamp(1.0, MOST_LOOKS) as u32;
        let mut stops = Vec::new();
        for i in 1..=looks {
            let look = from.lerp(to, i as f32 / looks as f32);
            let centre = guide.centre_at(look, grid, picker);
            match path.distance(centre) > LEAP * 2.0 * dabs.options.get(RADIUS) {
                true => path.jump_to(centre, |stop| stops.push(stop)),
                false => path.line_to(centre, |stop| stops.push(stop)),
            }
        }
        guide.at = to;
        self.tool.centre_vx = path.end();
        self.dab_at(&stops);
        self.leave_ground();
    }

    /// Something else has moved the tool: the brush follows.
    pub(super) fn dabs_moved(&mut self) {
        let to = self.tool.centre_vx;
        let mut stops = Vec::new();
        if let Some(Stroke { work: Work::Dabs(dabs), path, .. }) = &mut self.stroke {
            path.scale(dabs.pen.size(self.grip.now));
            path.line_to(to, |stop| stops.push(stop));
        }
        self.dab_at(&stops);
    }

    fn dab_at(&mut self, stops: &[Vec3]) {
        for (&stop, touch) in stops.iter().zip(self.grip.on_way(stops.len())) {
            let Some(Stroke { work: Work::Dabs(dabs), .. }) = &mut self.stroke else { return };
            dabs.touch = touch;
            if dabs.normal_used() == SurfaceNormal::OfEachUse {
                let surface = self.session.document().stroke_surface();
                let normal = normal_around(surface, stop, dabs.options.get(RADIUS));
                dabs.normal = normal.and_then(Vec3::try_normalize).unwrap_or(dabs.normal);
            }
            let command = dabs.command(stop);
            dabs.last = stop;
            if command.is_some_and(|command| !self.execute(&command)) {
                self.cancel_stroke();
            }
        }
    }
}

/// Where a brush at `from` goes whose rope is led to `to`: it stays while the rope hangs, so that a hand that trembles
/// draws an even line.
fn on_rope(from: Vec2, to: Vec2, length_px: f32) -> Vec2 {
    let left = (to.distance(from) - length_px).max(0.0);
    from.move_towards(to, left)
}

/// The direction out of the clay in a ball: away from the middle of what is there. None where nothing is, or all.
pub(super) fn normal_around(grid: &Grid, centre: Vec3, radius: f32) -> Option<Vec3> {
    let edges = grid.voxel_size() / grid.voxel_size().min_element();
    let reach = radius.max(2.0);
    let step = (reach / STEPS).max(1.0);
    let steps = (reach / step) as i32;
    let mut sum = Vec3::ZERO;
    for z in -steps..=steps {
        for y in -steps..=steps {
            for x in -steps..=steps {
                let offset = IVec3::new(x, y, z).as_vec3() * step;
                let v = (centre + offset / edges).floor().as_ivec3();
                if offset.length() <= reach && grid.get(v) {
                    sum -= offset;
                }
            }
        }
    }
    (sum.length() > 0.05 * reach).then_some(sum)
}

#[cfg(test)]
mod tests {
    use glam::UVec3;

    use super::*;

    #[test]
    fn a_brush_follows_at_the_end_of_its_rope_and_evens_out_what_trembles() {
        assert_eq!(on_rope(Vec2::ZERO, Vec2::new(30.0, 40.0), 0.0), Vec2::new(30.0, 40.0));
        assert_eq!(on_rope(Vec2::ZERO, Vec2::new(3.0, 4.0), 5.0), Vec2::ZERO);
        assert_eq!(on_rope(Vec2::ZERO, Vec2::new(6.0, 8.0), 5.0), Vec2::new(3.0, 4.0));
        // A line with a zigzag of 4 pixels to each side.
        let widest = |length_px: f32| {
            let mut at = Vec2::ZERO;
            let mut widest = 0.0f32;
            for i in 1..200 {
                let side = if i % 2 == 0 { 4.0 } else { -4.0 };
                at = on_rope(at, Vec2::new(i as f32 * 2.0, side), length_px);
                widest = widest.max(if i > 100 { at.y.abs() } else { 0.0 });
            }
            widest
        };
        assert_eq!(widest(0.0), 4.0);
        assert!(widest(40.0) < 1.0, "{}", widest(40.0));
    }

    #[test]
    fn the_plane_of_a_surface_is_found_and_there_is_none_within_or_outside_clay() {
        let mut grid = Grid::new(UVec3::splat(48), Vec3::ONE, 1 << 30).unwrap();
        let way = Vec3::new(2.0, 3.0, -1.0).normalize();
        for i in 0..48 * 48 * 48 {
            let v = grid.voxel_coords(i);
            grid.set(v.as_ivec3(), (v.as_vec3() - 23.5).dot(way) < 0.0);
        }
        for radius in [3.0, 9.0, 20.0] {
            let normal = normal_around(&grid, Vec3::splat(24.0), radius).unwrap().normalize();
            assert!(normal.dot(way) > 0.97, "{radius}: {normal}");
        }
        assert_eq!(normal_around(&grid, Vec3::splat(24.0) + way * 12.0, 6.0), None);
        let within = normal_around(&grid, Vec3::splat(24.0) - way * 12.0, 6.0);
        assert!(within.is_none_or(|n| n.length() < 30.0), "{within:?}");
    }
}

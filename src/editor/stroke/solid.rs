//! Strokes of solids: the tool sweeps along a path in the grid.

use std::collections::VecDeque;

use glam::{Vec2, Vec3};

use super::lead::{Lead, PointerLead, StrokeScene};
use super::sweep::{Sweep, SweepSegment};
use crate::command::Command;
use crate::editor::surface_guide::{LEAP, SurfaceGuide};
use crate::editor::tool::ToolState;
use crate::input::ToolMode;
use crate::picking::Picker;
use crate::tools::solid::Primitive;

/// The input that moves a solid.
pub enum SolidGuide {
    /// A drag of the pointer over the surface.
    Surface(PointerGuide),
    /// Any input that moves the tool while a key, a button or a hand holds it down. `hovering`: the pointer, if it
    /// moved the tool last.
    Tool { hovering: Option<PointerGuide> },
}

/// The pointer on the surface, with the tool on it.
pub struct PointerGuide {
    surface: SurfaceGuide,
    /// From the surface to the centre of a tool resting on it.
    lift: Vec3,
}

impl PointerGuide {
    /// Starts with the pointer at `at` (pixels) and the tool on `point` of the surface.
    pub fn new(at: Vec2, point: Vec3, scene: &StrokeScene, picker: &Picker) -> PointerGuide {
        let surface = SurfaceGuide::new(at, point, scene.grid(), picker);
        let lift = if scene.tool.stand { scene.tool.centre_vx - point } else { Vec3::ZERO };
        PointerGuide { surface, lift }
    }
}

/// A stroke of a solid.
pub struct SolidStroke {
    mode: ToolMode,
    unpaints: bool,
    guide: SolidGuide,
    sweep: Sweep,
    due: VecDeque<SweepSegment>,
    uses: u32,
}

impl SolidStroke {
    /// Begins a stroke at the tool. `unpaints`: it paints the bare colour.
    pub fn new(
        mode: ToolMode,
        unpaints: bool,
        guide: SolidGuide,
        scene: &StrokeScene,
    ) -> SolidStroke {
        let tool = scene.tool.primitive();
        let sweep = Sweep::new(&tool, scene.edges());
        SolidStroke {
            mode,
            unpaints,
            guide,
            sweep,
            due: VecDeque::from([SweepSegment::place(&tool)]),
            uses: 0,
        }
    }

    fn pointer_guide(&self) -> Option<&PointerGuide> {
        match &self.guide {
            SolidGuide::Surface(guide) => Some(guide),
            SolidGuide::Tool { hovering } => hovering.as_ref(),
        }
    }
}

impl Lead for SolidStroke {
    fn point_at(&mut self, to: Vec2, scene: &mut StrokeScene, picker: &Picker) {
        let SolidStroke { guide, sweep, due, .. } = self;
        let (SolidGuide::Surface(guide) | SolidGuide::Tool { hovering: Some(guide) }) = guide
        else {
            return;
        };
        let (tool, grid) = (&mut *scene.tool, scene.document.grid());
        let lift = guide.lift;
        let mut end = None;
        guide.surface.go_to(to, 0.0, grid, picker, |point| {
            go_over_surface(sweep, tool, point + lift, due);
            end = Some(point);
        });
        if let Some(point) = end {
            tool.move_to(point + lift);
            scene.anchor.follow(point);
        }
    }

    fn tool_moved(&mut self, scene: &mut StrokeScene, _: &Picker) {
        if let SolidGuide::Tool { hovering } = &mut self.guide {
            *hovering = None;
            let due = &mut self.due;
            self.sweep
                .lead(&at(scene.tool, scene.tool.centre_vx), |segment| due.push_back(segment));
        }
    }

    fn tool_put(&mut self, at: Vec2, point: Vec3, scene: &mut StrokeScene, picker: &Picker) {
        if let SolidGuide::Tool { hovering } = &mut self.guide {
            *hovering = Some(PointerGuide::new(at, point, scene, picker));
            go_over_surface(&mut self.sweep, scene.tool, scene.tool.centre_vx, &mut self.due);
        }
    }

    fn finish(&mut self, scene: &mut StrokeScene) {
        let due = &mut self.due;
        self.sweep.finish(&scene.tool.primitive(), |segment| due.push_back(segment));
    }

    fn next(&mut self, scene: &mut StrokeScene, _: Option<&Picker>) -> Option<Command> {
        let segment = self.due.pop_front()?;
        self.uses += 1;
        let bare = self.unpaints.then(|| scene.bare_colour());
        Some(scene.tool.in_use(scene.grip.now, bare).command(self.mode, &segment))
    }

    fn shift(&mut self, by_vx: Vec3) {
        self.sweep.shift(by_vx);
        self.due.iter_mut().for_each(|segment| segment.shift(by_vx));
        if let SolidGuide::Surface(guide) | SolidGuide::Tool { hovering: Some(guide) } =
            &mut self.guide
        {
            guide.surface.shift(by_vx);
        }
    }

    fn uses(&self) -> u32 {
        self.uses
    }

    fn pointer(&self) -> PointerLead {
        match self.guide {
            SolidGuide::Surface(_) => PointerLead::Drag,
            SolidGuide::Tool { .. } => PointerLead::None,
        }
    }

    fn is_led_over(&self, picker: &Picker) -> bool {
        self.pointer_guide().is_some_and(|guide| guide.surface.is_of(picker))
    }

    fn depends_on_picture(&self) -> bool {
        self.pointer_guide().is_some()
    }
}

/// Returns the solid in hand with its centre at a point, or in the middle of the voxel there.
fn at(tool: &ToolState, centre_vx: Vec3) -> Primitive {
    Primitive { centre_vx: tool.snapped(centre_vx), ..tool.primitive() }
}

/// Moves `sweep` over the surface to `centre_vx`: straight, or, at a jump of the surface, with the tool lifted.
fn go_over_surface(
    sweep: &mut Sweep,
    tool: &ToolState,
    centre_vx: Vec3,
    due: &mut VecDeque<SweepSegment>,
) {
    if sweep.distance(centre_vx) > LEAP * 2.0 * tool.half().max_element() {
        sweep.finish(&tool.primitive(), |segment| due.push_back(segment));
        sweep.jump(&at(tool, centre_vx), |segment| due.push_back(segment));
    } else {
        sweep.lead(&at(tool, centre_vx), |segment| due.push_back(segment));
    }
}

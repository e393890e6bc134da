//! A marker box whose faces lie in the surface of the sculpture: every pixel of such a face shows it,
//! from any angle and distance, at the scale of a window, of a camera and of a headset.
//!
//! The sculpture is lit evenly, so a pixel is either stone or stone under the face's colour. Which
//! pixels must show the face is worked out here, from the rays in double precision.

use glam::{Affine3A, DVec3, IVec3, Quat, UVec2, UVec3, Vec3};
use virtual_sculpture::document::{Document, Limits};
use virtual_sculpture::gpu::{Device, Frames};
use virtual_sculpture::render::RenderMode;
use virtual_sculpture::render::overlay::ToolPreview;
use virtual_sculpture::render::{Background, FrameDesc, Renderer, SmoothSurface};
use virtual_sculpture::scenes::Random;
use virtual_sculpture::screen::offscreen::FORMAT;
use virtual_sculpture::sculpture::history::Contents;
use virtual_sculpture::sculpture::{ColourDepth, Grid, Material, Rgb};
use virtual_sculpture::shade::{Lighting, Pixels};
use virtual_sculpture::tools::solid::{Primitive, Solid};
use virtual_sculpture::view::{Camera, Eye, PixelRays};

use super::fixture::with_device;

pub const SIZE: UVec2 = UVec2::new(320, 240);
pub const STONE: Rgb = Rgb::new(150, 150, 150);
/// Has no green, of which stone has much.
pub const FACE: Rgb = Rgb::new(255, 0, 255);
/// Pixels by which a face must reach beyond a pixel for it to be asked about: its outline is rounded.
const MARGIN_PX: f32 = 0.75;

/// A box in grid coordinates.
#[derive(Clone, Copy)]
struct Cuboid {
    min: DVec3,
    max: DVec3,
}

impl Cuboid {
    fn new(min: IVec3, max: IVec3) -> Cuboid {
        Cuboid { min: min.as_dvec3(), max: max.as_dvec3() }
    }

    /// Where a ray from outside enters, and the axis of the face that it enters by.
    fn entry(&self, rays: &PixelRays, at: (f32, f32)) -> Option<(f64, usize)> {
        let origin = rays.origin.as_dvec3();
        let direction = rays.corner.as_dvec3()
            + rays.step_x.as_dvec3() * f64::from(at.0)
            + rays.step_y.as_dvec3() * f64::from(at.1);
        let (a, b) = ((self.min - origin) / direction, (self.max - origin) / direction);
        let (low, high) = (a.min(b), a.max(b));
        let (enter, leave) = (low.max_element(), high.min_element());
        (0.0 < enter && enter < leave).then(|| (enter, low.max_position()))
    }

    fn preview(&self) -> ToolPreview {
        let primitive = Primitive {
            solid: Solid::Cuboid,
            centre_vx: ((self.min + self.max) * 0.5).as_vec3(),
            half: ((self.max - self.min) * 0.5).as_vec3(),
            rotation: Quat::IDENTITY,
        };
        ToolPreview { primitive, voxel_size: Vec3::ONE, colour: FACE, opacity: [1.0, 0.0] }
    }
}

/// A cube of stone in the middle of an empty grid.
fn document(edge: u32, stone: Cuboid) -> Document {
    let grid = Grid::new(UVec3::splat(edge), Vec3::ONE, 1 << 30).unwrap();
    let material = Material::for_grid(&grid, ColourDepth::None, STONE);
    let mut document = Document::from_contents(Contents::new(grid, material), Limits::default());
    let (centre, half) = ((stone.min + stone.max) * 0.5, (stone.max - stone.min) * 0.5);
    let at = format!("at={},{},{}", centre.x, centre.y, centre.z);
    let half = format!("half={},{},{}", half.x, half.y, half.z);
    document.apply(&format!("add cuboid {at} {half}").parse().unwrap()).unwrap();
    document
}

pub struct Painter {
    renderer: Renderer,
    frames: Frames,
    pub smooth_surface: SmoothSurface,
}

impl Painter {
    pub fn paint(
        &mut self,
        document: &mut Document,
        eye: &Eye,
        mode: RenderMode,
        previews: &[ToolPreview],
    ) -> Pixels {
        let white = Rgb::new(255, 255, 255);
        let even = Lighting { lights: [None; 4], sky: white, ground: white, ..Lighting::default() };
        let desc = FrameDesc {
            eyes: std::slice::from_ref(eye),
            world_from_grid: Affine3A::IDENTITY,
            smooth_surface: self.smooth_surface,
            sample: 0,
            mode,
            lighting: even,
            show_mask: false,
            background: Background::Gradient { top: Vec3::ZERO, bottom: Vec3::ZERO },
            ground: None,
            smooth_edges: false,
            video: None,
            previews,
            lines: &[],
        };
        let mut recorder = self.frames.begin().unwrap();
        self.renderer.paint(&mut recorder, self.frames.slot(), document, &desc).unwrap();
        self.frames.submit(recorder, &[], &[]).unwrap();
        self.renderer.read_back().unwrap().remove(0)
    }
}

/// Eyes about the cube: all around at a distance from its middle, and low over its faces.
fn eyes(stone: Cuboid, distance: f32, near: f32, fov_y_deg: f32, seed: u64) -> Vec<Eye> {
    let middle = ((stone.min + stone.max) * 0.5).as_vec3();
    let half = ((stone.max - stone.min) * 0.5).as_vec3().x;
    let mut random = Random(seed);
    let mut part = || 2.0 * random.unit() - 1.0;
    let mut directions: Vec<Vec3> = (0..8).map(|_| Vec3::new(part(), part(), part())).collect();
    // Degrees above the plane of the upper face, and of the one in front.
    for elevation in [0.1f32, 0.5, 3.0, 10.0] {
        let lift = (half + distance * elevation.to_radians().sin()) / distance;
        directions.push(Vec3::new(0.3, 0.0, 1.0).normalize() + Vec3::Y * lift);
        directions.push(Vec3::new(1.0, -0.2, 0.0).normalize() + Vec3::Z * lift);
    }
    let camera = |direction: Vec3| Camera {
        eye: middle + direction.normalize_or(Vec3::Z) * distance,
        target: middle,
        up: Vec3::new(0.1, 1.0, 0.05),
        fov_y_rad: fov_y_deg.to_radians(),
        near,
    };
    directions.into_iter().map(|direction| camera(direction).eye(SIZE)).collect()
}

/// Paints `marker` over the cube and demands that its faces show where they lie in the surface.
/// Gives how many pixels were asked about.
fn ask(
    painter: &mut Painter,
    document: &mut Document,
    (stone, marker): (Cuboid, Cuboid),
    eye: &Eye,
    mode: RenderMode,
) -> usize {
    let rays = eye.pixel_rays(&Affine3A::IDENTITY);
    let bare = painter.paint(document, eye, mode, &[]);
    let marked = painter.paint(document, eye, mode, &[marker.preview()]);
    let (mut asked, mut lacking) = (0, Vec::new());
    for y in 0..SIZE.y {
        for x in 0..SIZE.x {
            let middle = (x as f32 + 0.5, y as f32 + 0.5);
            let Some((t, axis)) = marker.entry(&rays, middle) else { continue };
            let on_face = |at: (f32, f32)| {
                let enters = |cuboid: &Cuboid| cuboid.entry(&rays, at).filter(|(_, a)| *a == axis);
                let Some(((t, _), (surface, _))) = enters(&marker).zip(enters(&stone)) else {
                    return false;
                };
                (t - surface).abs() < 1e-9 * t
            };
            let around = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
            let corner = |(i, j): (f32, f32)| (middle.0 + i * MARGIN_PX, middle.1 + j * MARGIN_PX);
            // Nearer than the near plane nothing is drawn.
            let near = t < 1.01 * f64::from(eye.projection.w_axis.z);
            if near || !on_face(middle) || !around.into_iter().all(|to| on_face(corner(to))) {
                continue;
            }
            let i = (x + y * SIZE.x) as usize;
            assert!(bare.rgba[i][1] > 120, "{mode:?}: no stone at {x}, {y}: {:?}", bare.rgba[i]);
            asked += 1;
            if marked.rgba[i][1] > 60 {
                lacking.push((x, y));
            }
        }
    }
    assert!(
        lacking.is_empty(),
        "{mode:?}: {} of {asked} pixels do not show the face, {:?} ...; near {}, eye {:?}",
        lacking.len(),
        &lacking[..lacking.len().min(6)],
        eye.projection.w_axis.z,
        rays.origin,
    );
    asked
}

pub fn painter(device: &std::sync::Arc<Device>) -> Painter {
    let renderer = Renderer::new(device, FORMAT).unwrap();
    let frames = Frames::new(device).unwrap();
    Painter { renderer, frames, smooth_surface: SmoothSurface::Never }
}

/// Distances in half edges of the cube, near planes as a share of a half edge, and angles.
const VIEWS: [(f32, f32, f32); 6] = [
    // A window: from very near to far away.
    (1.06, 1e-3, 45.0),
    (4.0, 1e-3, 45.0),
    (40.0, 1e-3, 6.0),
    (1000.0, 1e-3, 0.2),
    // A camera 0.4 m before a print of 10 cm, and a headset around a sculpture of half a metre.
    (8.0, 0.2, 35.0),
    (2.0, 0.2, 95.0),
];

/// The whole cube, half of one face of it, and more than one face.
fn markers(low: i32, high: i32) -> [(Cuboid, Cuboid); 3] {
    let stone = Cuboid::new(IVec3::splat(low), IVec3::splat(high));
    let (quarter, edge) = ((high - low) / 4, high);
    let sunk = Cuboid::new(
        IVec3::new(low + quarter, edge - quarter, low + quarter),
        IVec3::new(edge - quarter, edge, edge),
    );
    let wide = Cuboid::new(
        IVec3::new(low - quarter, low + quarter, low + quarter),
        IVec3::new(edge + quarter, edge + quarter, edge),
    );
    [(stone, stone), (stone, sunk), (stone, wide)]
}

#[test]
fn faces_in_the_surface_show_wherever_they_are_seen_from() {
    with_device(|device| {
        let mut painter = painter(device);
        let (low, high) = (24, 88);
        let half = 32.0;
        let mut document = document(112, markers(low, high)[0].0);
        let mut asked = 0;
        for (seed, (distance, near, fov)) in (0..).zip(VIEWS) {
            for boxes in markers(low, high) {
                for eye in eyes(boxes.0, distance * half, near * half, fov, seed) {
                    asked += ask(&mut painter, &mut document, boxes, &eye, RenderMode::MarchGpu);
                }
            }
        }
        assert!(asked > 500_000, "{asked} pixels");
    });
}

#[test]
fn faces_in_the_surface_show_in_every_mode_and_on_large_sculptures() {
    with_device(|device| {
        for (edge, low, high) in [(112, 24, 88), (512, 40, 472)] {
            let half = 0.5 * (high - low) as f32;
            let boxes = markers(low, high)[1];
            let mut document = document(edge, boxes.0);
            let mut painter = painter(device);
            for mode in RenderMode::ALL {
                for (seed, (distance, near, fov)) in (10..).zip([VIEWS[0], VIEWS[1], VIEWS[4]]) {
                    let eyes = eyes(boxes.0, distance * half, near * half, fov, seed);
                    for eye in eyes.iter().step_by(5) {
                        ask(&mut painter, &mut document, boxes, eye, mode);
                    }
                }
            }
        }
    });
}

//! The scenes of the benchmark, and the view of them.

use std::path::{Path, PathBuf};

use glam::{UVec2, Vec3};

use crate::document::Document;
use crate::format::{self, FormatError, options::ImportOptions};
use crate::progress::Progress;
use crate::render::StereoOptions;
use crate::scenes;
use crate::sculpture::history::Contents;
use crate::sculpture::{ColourDepth, Grid, GridError, Limits, Material, Rgb};
use crate::view::{Camera, Eye};

/// A sculpture to measure.
pub enum BenchSubject {
    Cube,
    Engine,
    Cheese,
    Gyroid,
    File(PathBuf),
}

impl BenchSubject {
    pub const STANDARD: [BenchSubject; 4] =
        [BenchSubject::Cube, BenchSubject::Engine, BenchSubject::Cheese, BenchSubject::Gyroid];

    pub fn of_name(name: &str) -> BenchSubject {
        match name {
            "cube" => BenchSubject::Cube,
            "engine" => BenchSubject::Engine,
            "cheese" => BenchSubject::Cheese,
            "gyroid" => BenchSubject::Gyroid,
            file => BenchSubject::File(PathBuf::from(file)),
        }
    }

    pub fn name(&self) -> String {
        match self {
            BenchSubject::Cube => "cube 256".to_string(),
            BenchSubject::Engine => "engine 256".to_string(),
            BenchSubject::Cheese => "cheese 512".to_string(),
            BenchSubject::Gyroid => "gyroid 512".to_string(),
            BenchSubject::File(path) => {
                let name = path.file_name().unwrap_or(path.as_os_str());
                name.to_string_lossy().into_owned()
            }
        }
    }

    /// Returns the path of its file, if it is one.
    pub fn path(&self) -> Option<&Path> {
        match self {
            BenchSubject::File(path) => Some(path),
            _ => None,
        }
    }

    pub fn make(
        &self,
        import: &ImportOptions,
        limits: Limits,
        progress: &dyn Progress,
    ) -> Result<Document, FormatError> {
        let contents = match self {
            BenchSubject::Cube => without_colour(scenes::solid_cube(256))?,
            BenchSubject::Engine => without_colour(scenes::engine_like(256))?,
            BenchSubject::Cheese => without_colour(scenes::cheese(512, 2000, 1))?,
            BenchSubject::Gyroid => without_colour(scenes::gyroid(512, 1))?,
            BenchSubject::File(path) => format::load(path, import, &limits, progress)?.contents,
        };
        Ok(Document::from_contents(contents, limits))
    }
}

pub(super) fn without_colour(grid: Result<Grid, GridError>) -> Result<Contents, FormatError> {
    let grid = grid?;
    let base = Rgb::new(200, 190, 170);
    let material = Material::for_grid(&grid, ColourDepth::None, base);
    Ok(Contents::new(grid, material))
}

/// Returns the eye at a fixed position relative to the sculpture, with a vertical field of view of 45 degrees: 1.9
/// times its longest edge from the centre, in the direction (0.8, 0.6, 1). `size`: of the picture, in pixels.
pub fn eye_of(document: &Document, size: UVec2) -> Eye {
    let grid = document.grid();
    let edge = (grid.dims().as_vec3() * grid.voxel_size()).max_element();
    let eye = Vec3::new(0.8, 0.6, 1.0) / 2f32.sqrt() * 1.9 * edge;
    Camera { eye, near: 0.01 * edge, ..Camera::default() }.eye(size)
}

/// Returns that eye, or with `count` 2 the left and the right one around it, as in `stereo`.
pub fn eyes_of(document: &Document, size: UVec2, count: u32, stereo: &StereoOptions) -> Vec<Eye> {
    let mono = eye_of(document, size);
    if count < 2 {
        return vec![mono];
    }
    let middle = document.grid().dims().as_vec3() * 0.5;
    let seen = mono.eye_from_world * document.world_from_grid();
    let distance = -seen.transform_point3(middle).z;
    stereo.rig(distance.max(f32::MIN_POSITIVE)).eyes(&mono).to_vec()
}

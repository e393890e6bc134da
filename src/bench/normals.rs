//! The accuracy of normals: angles between the normals of voxels and those of the analytic surfaces that made the
//! voxels, at random positions and rotations.
//!
//! Gives a table of the mean and the 99th percentile for each shape, for the moment of 81 voxels
//! ([`crate::shade::normal`]) and for the field ([`NormalField`]); and, for the ball of radius 100 lit from the eye,
//! the scatter of brightness at equal angles.

use glam::{Mat3, Quat, UVec3, Vec3};

use crate::progress::Progress;
use crate::scenes::Random;
use crate::sculpture::brick::local_coords;
use crate::sculpture::{Brick, Grid, GridError};
use crate::shade::NormalField;
use crate::shade::normal::gradient;

/// Half the edge of the cube around the examined place, and half that of the grid around it.
const LOOK_VX: f32 = 20.0;
const GRID_VX: u32 = 44;

/// The measurements for one shape.
struct ShapeErrors {
    name: String,
    moment: Spread,
    field: Spread,
}

/// Errors of normals.
#[derive(Default)]
struct Spread {
    degrees: Vec<f32>,
    /// Actual and ideal brightness, if the eye is in a fixed direction.
    brightness: Vec<[f32; 2]>,
}

impl Spread {
    fn take(&mut self, found: Option<Vec3>, exact: Vec3, to_eye: Vec3) {
        let found = found.unwrap_or(to_eye);
        self.degrees.push(found.angle_between(exact).to_degrees());
        let cosine = exact.dot(to_eye);
        if cosine > 0.05 {
            self.brightness.push([cosine, found.normalize_or_zero().dot(to_eye)]);
        }
    }

    /// Returns mean and 99th percentile, in degrees.
    fn figures(&mut self) -> [f32; 2] {
        self.degrees.sort_unstable_by(f32::total_cmp);
        let count = self.degrees.len();
        let mean = self.degrees.iter().sum::<f32>() / count.max(1) as f32;
        let rank = (count * 99).div_ceil(100).max(1) - 1;
        [mean, self.degrees.get(rank).copied().unwrap_or_default()]
    }

    /// Returns the largest standard deviation of brightness at equal angles (in tenths of its cosine), in per cent of
    /// the range of brightness.
    fn ring(&self) -> f32 {
        let deviation = |tenth: usize| {
            let at_angle = |[cosine, _]: &&[f32; 2]| (cosine * 10.0) as usize == tenth;
            let errors =
                self.brightness.iter().filter(at_angle).map(|[exact, found]| found - exact);
            let (count, sum, squares) =
                errors.fold((0.0, 0.0, 0.0), |(n, sum, sq), e| (n + 1.0, sum + e, sq + e * e));
            let count = f32::max(count, 1.0);
            (squares / count - (sum / count).powi(2)).max(0.0).sqrt()
        };
        (0..10).map(deviation).fold(0.0, f32::max) * 100.0
    }
}

/// Returns the table, as text.
pub fn report(progress: &dyn Progress) -> Result<String, GridError> {
    progress.begin("measuring normals");
    let mut random = Random(1);
    let mut rows = Vec::new();
    for radius in [16.0f32, 40.0, 100.0] {
        rows.push(ball(radius, &mut random)?);
    }
    rows.push(plane(&mut random)?);
    rows.extend(cube(&mut random)?);
    rows.push(wall(&mut random)?);
    progress.end();
    let ring = rows.get(2).map(|row| [row.moment.ring(), row.field.ring()]).unwrap_or_default();
    let mut text = format!("{:32} {:>14} {:>14}", "degrees: mean, 99 of 100", "moment", "field");
    for row in &mut rows {
        let [moment, field] = [row.moment.figures(), row.field.figures()];
        text += &format!(
            "\n{:32} {:7.2} {:6.2} {:7.2} {:6.2}",
            row.name, moment[0], moment[1], field[0], field[1]
        );
    }
    let [moment, field] = ring;
    text += &format!("\n{:32} {moment:12.2} % {field:12.2} %", "ball of 100, brightness scatter");
    Ok(text)
}

/// Returns a grid of the voxels whose centres are `inside`, and its field.
fn grid_of(edge_vx: u32, inside: &(dyn Fn(Vec3) -> bool + Sync)) -> Result<Grid, GridError> {
    let mut grid = Grid::new(UVec3::splat(edge_vx), Vec3::ONE, 1 << 30)?;
    grid.fill_bricks(|b| {
        let mut brick = Brick::EMPTY;
        for i in 0..512 {
            let [x, y, z] = local_coords(i);
            brick.set(x, y, z, inside((b * 8 + UVec3::new(x, y, z)).as_vec3() + 0.5));
        }
        brick
    });
    Ok(grid)
}

/// Calls `take` with the centre of each surface voxel for which `wanted` gives a row and an exact normal.
fn compare(
    grid: &Grid,
    to_eye: Vec3,
    rows: &mut [ShapeErrors],
    wanted: &dyn Fn(Vec3) -> Option<(usize, Vec3)>,
) {
    let field = NormalField::of(grid);
    for (b, brick) in grid.nonempty_bricks() {
        brick.for_each(|i| {
            let v = b * 8 + UVec3::from(local_coords(i));
            let at = v.as_ivec3();
            let faces = [at.with_x(at.x - 1), at.with_x(at.x + 1), at.with_y(at.y - 1)];
            let more = [at.with_y(at.y + 1), at.with_z(at.z - 1), at.with_z(at.z + 1)];
            if faces.iter().chain(&more).all(|v| grid.get(*v)) {
                return;
            }
            if let Some((row, exact)) = wanted(v.as_vec3() + 0.5) {
                let moment = gradient(grid, v).try_normalize();
                rows[row].moment.take(moment, exact, to_eye);
                rows[row].field.take(field.normal(v), exact, to_eye);
            }
        });
    }
}

fn row(name: impl Into<String>) -> ShapeErrors {
    ShapeErrors { name: name.into(), moment: Spread::default(), field: Spread::default() }
}

fn direction(random: &mut Random) -> Vec3 {
    loop {
        let v = Vec3::new(random.unit(), random.unit(), random.unit()) * 2.0 - 1.0;
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

fn offset(random: &mut Random) -> Vec3 {
    Vec3::new(random.unit(), random.unit(), random.unit())
}

/// Returns whether a place is far enough from the borders of a grid of [`GRID_VX`] * 2.
fn is_inner(p: Vec3) -> bool {
    (p - GRID_VX as f32).abs().max_element() < LOOK_VX
}

fn ball(radius: f32, random: &mut Random) -> Result<ShapeErrors, GridError> {
    let mut rows = [row(format!("ball of radius {radius}"))];
    let to_eye = direction(random);
    // Patches, one of them seen from its own direction.
    for patch in 0..6 {
        let out = if patch == 0 { to_eye } else { direction(random) };
        let centre = Vec3::splat(GRID_VX as f32) + offset(random) - out * radius;
        let grid = grid_of(2 * GRID_VX, &|p| p.distance(centre) <= radius)?;
        compare(&grid, to_eye, &mut rows, &|p| is_inner(p).then(|| (0, (p - centre).normalize())));
    }
    let [row] = rows;
    Ok(row)
}

fn plane(random: &mut Random) -> Result<ShapeErrors, GridError> {
    let mut rows = [row("planes")];
    for _ in 0..16 {
        let out = direction(random);
        let place = Vec3::splat(GRID_VX as f32) + offset(random);
        let grid = grid_of(2 * GRID_VX, &|p| (p - place).dot(out) <= 0.0)?;
        compare(&grid, out, &mut rows, &|p| is_inner(p).then_some((0, out)));
    }
    let [row] = rows;
    Ok(row)
}

/// Measures faces, by distance from the nearest edge.
fn cube(random: &mut Random) -> Result<[ShapeErrors; 4], GridError> {
    let bands = ["beyond 3 voxels", "2 to 3", "1 to 2", "0 to 1"];
    let mut rows = bands.map(|band| row(format!("cubes, from edges {band}")));
    for turn in 0..6 {
        let turned = Quat::from_rotation_arc(direction(random), direction(random));
        let axes = if turn == 0 { Mat3::IDENTITY } else { Mat3::from_quat(turned) };
        let (centre, half) = (Vec3::splat(GRID_VX as f32) + offset(random), 20.3);
        let local = |p: Vec3| axes.transpose() * (p - centre);
        let grid = grid_of(2 * GRID_VX, &|p| local(p).abs().max_element() <= half)?;
        compare(&grid, axes.z_axis, &mut rows, &|p| {
            let p = local(p);
            let face = p.abs().max_position();
            let mut out = Vec3::ZERO;
            out[face] = p[face].signum();
            let mut others = p.abs();
            others[face] = 0.0;
            let from_edge = half - others.max_element();
            let band = 3 - (from_edge.clamp(0.0, 3.0) as usize);
            Some((band, axes * out))
        });
    }
    Ok(rows)
}

/// Measures the sides of walls of two voxels.
fn wall(random: &mut Random) -> Result<ShapeErrors, GridError> {
    let mut rows = [row("walls 2 voxels thick")];
    for turn in 0..9 {
        let out = Vec3::AXES.get(turn).copied().unwrap_or_else(|| direction(random));
        let place = Vec3::splat(GRID_VX as f32) + offset(random);
        let height = |p: Vec3| (p - place).dot(out);
        let grid = grid_of(2 * GRID_VX, &|p| height(p).abs() <= 1.0)?;
        compare(&grid, out, &mut rows, &|p| {
            // Exactly in the middle, neither side is right.
            let side = Some(height(p)).filter(|height| height.abs() > 0.3)?;
            is_inner(p).then_some((0, out * side.signum()))
        });
    }
    let [row] = rows;
    Ok(row)
}

//! Computes every value of the definition, voxel by voxel and in f64.

use super::*;
use glam::{DVec3, I64Vec3};

const WEIGHTS: [f64; 9] = [1.0, 5.0, 24.0, 58.0, 78.0, 58.0, 24.0, 5.0, 1.0];

pub struct Sample {
    pub voxel: I64Vec3,
    pub at: DVec3,
    pub normal: DVec3,
    pub planarity: f64,
}

/// Returns the cumulative normal distribution, by a sum.
fn half_space(share: f64) -> (f64, f64) {
    let deviation = (430.0f64 / 254.0).sqrt();
    let (mut x, mut sum) = (-5.0, 0.0);
    let density = |x: f64| (-x * x / 2.0).exp() / std::f64::consts::TAU.sqrt();
    while sum < share && x < 5.0 {
        sum += density(x) * 1e-4;
        x += 1e-4;
    }
    ((x * deviation).clamp(0.0, 1.0), density(x) / deviation)
}

pub fn sample(grid: &Grid, voxel: UVec3) -> Sample {
    let (mut sum, mut slope) = (0.0, DVec3::ZERO);
    for z in -4i32..=4 {
        for y in -4i32..=4 {
            for x in -4i32..=4 {
                let offset = IVec3::new(x, y, z);
                if grid.get(voxel.as_ivec3() + offset) {
                    let weights = (offset + 4).to_array().map(|i| WEIGHTS[i as usize]);
                    let weight: f64 = weights.iter().product();
                    sum += weight;
                    slope += offset.as_dvec3() * weight;
                }
            }
        }
    }
    // In steps, like the table of the field.
    let share = (sum / 254f64.powi(3) * 1024.0).floor() / 1024.0;
    let (depth, density) = half_space(share);
    let normal = -slope / slope.length().max(1.0);
    Sample {
        voxel: voxel.as_i64vec3(),
        at: voxel.as_dvec3() + 0.5 + normal * depth,
        normal,
        planarity: (slope.length() / (430.0 * 254.0 * 254.0) / density).min(1.0),
    }
}

struct Cell {
    cell: I64Vec3,
    at: DVec3,
    normal: DVec3,
    weight: f64,
}

fn cells(samples: &[Sample]) -> Vec<Cell> {
    let mut by_cell = std::collections::BTreeMap::<[i64; 3], Vec<&Sample>>::new();
    for sample in samples {
        by_cell.entry((sample.voxel / 2).to_array()).or_default().push(sample);
    }
    let merge = |(cell, samples): ([i64; 3], Vec<&Sample>)| {
        let weights: Vec<f64> = samples.iter().map(|s| s.planarity.powi(24) + 1e-9).collect();
        let weight = weights.iter().sum::<f64>();
        let mean = |of: &dyn Fn(&Sample) -> DVec3| {
            samples.iter().zip(&weights).map(|(s, w)| of(s) * *w).sum::<DVec3>() / weight
        };
        let normal = mean(&|s| s.normal).normalize_or_zero();
        Cell { cell: cell.into(), at: mean(&|s| s.at), normal, weight }
    };
    by_cell.into_iter().map(merge).collect()
}

fn sum<'a>(
    cells: impl Iterator<Item = (&'a Cell, DVec3)>,
    at: DVec3,
    estimate: DVec3,
    reach: f64,
) -> DVec3 {
    cells.fold(DVec3::ZERO, |sum, (cell, normal)| {
        let offset = cell.at - at;
        let near = (1.0 - offset.length_squared() / (reach * reach)).max(0.0);
        let flat = (1.0 - (offset.dot(normal) / 2.5).powi(2)).max(0.0);
        let alike = ((normal.dot(estimate) - 0.4) / 0.6).max(0.0);
        sum + normal * (cell.weight * near * (flat * alike).powi(2))
    })
}

/// Returns the normals of all surface voxels, 0 for none.
pub fn normals(grid: &Grid, voxels: &[UVec3]) -> Vec<DVec3> {
    let samples: Vec<_> = voxels.iter().map(|v| sample(grid, *v)).collect();
    let cells = cells(&samples);
    // Cells use the cube of 8^3 cells that begins two before their brick.
    let filtered: Vec<DVec3> = cells
        .iter()
        .map(|own| {
            let low = own.cell / 4 * 4 - 2;
            let near = cells.iter().filter(|c| {
                (c.cell - low).cmpge(I64Vec3::ZERO).all()
                    && (c.cell - low).cmplt(I64Vec3::splat(8)).all()
            });
            let sum = sum(near.map(|c| (c, c.normal)), own.at, own.normal, 4.0);
            sum.try_normalize().unwrap_or(own.normal)
        })
        .collect();
    samples
        .iter()
        .map(|own| {
            let low = own.voxel / 4 * 2 - 3;
            let near = cells.iter().zip(&filtered).filter(|(c, _)| {
                (c.cell - low).cmpge(I64Vec3::ZERO).all()
                    && (c.cell - low).cmplt(I64Vec3::splat(8)).all()
            });
            let sum = sum(near.map(|(c, n)| (c, *n)), own.at, own.normal, 5.0);
            (sum + own.normal * 1e-4).normalize_or_zero()
        })
        .collect()
}

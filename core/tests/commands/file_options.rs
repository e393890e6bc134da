//! Random options for reading and writing files.

use glam::{UVec3, Vec3};
use proptest::prelude::*;
use sculpture_core::format::options::{
    Colouring, Cubic, Existence, ExportForm, ExportOptions, ImportOptions, MeshFill, MeshSize,
    Ordinal, RawLayout, ScanRegion,
};
use sculpture_core::format::{MeshOptions, MeshUp, Samples};
use sculpture_core::mesh::MeshKind;
use sculpture_core::sculpture::ColourDepth;
use sculpture_core::sculpture::orientation::Up;

use super::strategies::any_number;

/// Returns any options for reading a file.
pub fn import() -> impl Strategy<Value = ImportOptions> {
    let threshold = (-1e9f64..1e9).prop_map(Existence::Threshold);
    let range =
        (-1e9f64..1e9, 0f64..1e9).prop_map(|(least, more)| Existence::Range(least, least + more));
    let existence = prop_oneof![Just(Existence::Auto), threshold, range];
    let colouring = prop::sample::select(&Colouring::NAMED[..]).prop_map(|(choice, _)| choice);
    let colour_depth = prop::option::of(prop::sample::select(&ColourDepth::ALL[..]));
    let samples = prop::sample::select(&Samples::NAMED[..]).prop_map(|(samples, _)| samples);
    let dims = prop::array::uniform3(1u32..5000).prop_map(UVec3::from);
    let voxel_size = prop::array::uniform3(1e-6f32..1e6).prop_map(Vec3::from);
    let raw = (dims, samples, any::<u64>(), voxel_size).prop_map(
        |(dims, samples, skip_bytes, voxel_size)| RawLayout {
            dims,
            samples,
            skip_bytes,
            voxel_size,
        },
    );
    let upright = prop::option::of(prop::sample::select(&Up::NAMED[..]).prop_map(|(up, _)| up));
    let longest = (1u32..=4096).prop_map(MeshSize::LongestVx);
    let mesh_size = prop_oneof![longest, (1e-6f32..1e6).prop_map(MeshSize::VoxelMm)];
    let mesh_fill = prop::sample::select(&MeshFill::NAMED[..]).prop_map(|(fill, _)| fill);
    let of_mesh = (mesh_size, mesh_fill);
    let edge = (1e-6f32..1e6).prop_map(Cubic::EdgeMm);
    let cubic = prop_oneof![Just(Cubic::No), Just(Cubic::Finest), edge];
    let corners = prop::array::uniform6(0u32..5000).prop_map(|[a, b, c, d, e, f]| {
        let (a, b) = (UVec3::new(a, b, c), UVec3::new(d, e, f));
        ScanRegion { low: a.min(b), high: a.max(b) }
    });
    let ordinal = || prop::option::of((1u32..).prop_map(|number| Ordinal::new(number).unwrap()));
    let part = (prop::option::of(corners), ordinal(), ordinal());
    let of_volume = (part, cubic, any::<bool>(), any::<bool>());
    let of_all = (existence, colouring, colour_depth, upright, prop::option::of(raw));
    (of_all, of_mesh, of_volume).prop_map(|(of_all, of_mesh, of_volume)| {
        let (existence, colouring, colour_depth, upright, raw) = of_all;
        let ((region, channel, time), cubic, largest_piece, fill_holes) = of_volume;
        ImportOptions {
            existence,
            colouring,
            colour_depth,
            upright,
            raw,
            channel,
            time,
            region,
            cubic,
            largest_piece,
            fill_holes,
            mesh_size: of_mesh.0,
            mesh_fill: of_mesh.1,
        }
    })
}

/// Returns any options for writing a file.
pub fn export() -> impl Strategy<Value = ExportOptions> {
    let form = prop::sample::select(&ExportForm::NAMED[..]);
    let kind = prop::sample::select(&MeshKind::NAMED[..]);
    let up = prop::option::of(prop::sample::select(&MeshUp::NAMED[..]));
    let (voxel_mm, triangles) = (prop::option::of(any_number()), prop::option::of(any::<u64>()));
    (form, kind, any::<bool>(), up, voxel_mm, triangles).prop_map(
        |((form, _), (kind, _), points_only, up, voxel_mm, triangles)| {
            let up = up.map(|(up, _)| up);
            let mesh = MeshOptions { kind, points_only, up, voxel_mm, triangles };
            ExportOptions { form, mesh }
        },
    )
}

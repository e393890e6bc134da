//! Scans from practice; see `mod.rs`.

use super::*;

#[test]
fn tiff_of_imagej_with_channels_times_and_one_directory() {
    let (notes, voxel) = (&["its channels: 2; the first was taken"], FINE);
    check(fixture("04_tiff_imagej_2channels.tif"), Right { notes, voxel, ..scan() });
    let notes = &["its times: 2; the first was taken"];
    check(fixture("04_tiff_imagej_2times.tif"), Right { notes, voxel, ..scan() });
    check(fixture("05_tiff_imagej_one_ifd.tif"), Right { voxel, is_silent: true, ..scan() });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.tif");
    let file = std::fs::read(fixture("05_tiff_imagej_one_ifd.tif")).unwrap();
    std::fs::write(&path, &file[..file.len() - 20]).unwrap();
    assert!(load(&path, &ImportOptions::default()).unwrap_err().contains("bytes were expected"));
}

#[test]
fn tiff_of_ome_with_its_unit() {
    check(fixture("06_tiff_ome_spacing.ome.tif"), Right { voxel: FINE, ..scan() });
}

#[test]
fn tiff_with_palettes_and_packed_with_zstd_is_read() {
    let right = Right { file_dims: Some([24, 20, 10]), ..Right::default() };
    check(fixture("25_tiff_palette.tif"), right);
    check(fixture("25_tiff_zstd.tif"), scan());
}

#[test]
fn nrrd_with_units_and_extents() {
    for name in ["07_nrrd_microns.nrrd", "07_nrrd_axis_mins_maxs.nrrd"] {
        check(fixture(name), Right { voxel: FINE, is_silent: true, ..scan() });
    }
}

#[test]
fn nrrd_whose_colours_are_vectors() {
    let right = Right { colours: &[([200, 50, 0], 600)], ..Right::default() };
    check(fixture("08_nrrd_rgb_kind_vector.nrrd"), right);
}

#[test]
fn labels_with_their_own_colours_or_a_word_about_them() {
    let colours = &[([219, 130, 99], 504), ([240, 214, 145], 504), ([143, 237, 143], 504)];
    let notes = &["segments: 3 (liver, bone, tumour)"];
    check(fixture("09_slicer_segmentation.seg.nrrd"), Right { colours, notes, ..Right::default() });
    let notes = &["colouring `labels`"];
    check(fixture("09_labels_nointent.nii.gz"), Right { notes, ..Right::default() });
    let options = ImportOptions { colouring: Colouring::Labels, ..ImportOptions::default() };
    let loaded = load(&fixture("09_labels_nointent.nii.gz"), &options).unwrap();
    assert_eq!(loaded.contents.grid.opaque_count(), 1512);
    assert!(loaded.notes.is_empty(), "{:?}", loaded.notes);
}

#[test]
fn segments_in_several_layers_lie_over_one_another() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.seg.nrrd");
    // Two layers of four voxels, one of which belongs to both.
    let header = "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 4 1 1\nkinds: list domain domain domain\n\
                  space: left-posterior-superior\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\
                  Segment0_ID:=a\nSegment0_Color:=1 0 0\nSegment0_LabelValue:=1\nSegment0_Layer:=0\n\
                  Segment1_ID:=b\nSegment1_Color:=0 0 1\nSegment1_LabelValue:=1\nSegment1_Layer:=1\n\n";
    std::fs::write(&path, [header.as_bytes(), &[1, 0, 1, 1, 0, 1, 0, 0]].concat()).unwrap();
    let colours = &[([255, 0, 0], 1), ([0, 0, 255], 2)];
    check(path, Right { colours, count: Some(3), ..Right::default() });
}

#[test]
fn text_has_no_order_of_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("text.nrrd");
    let header =
        "NRRD0004\ntype: int16\ndimension: 3\nsizes: 2 2 1\nendian: big\nencoding: ascii\n\n";
    std::fs::write(&path, format!("{header}1 2 300 -4\n")).unwrap();
    let densities = |path: &Path| -> Vec<f32> {
        let options = ImportOptions::default();
        let volume = format::load_volume(path, &options, &Limits::default(), &()).unwrap();
        (0..4).filter_map(|i| volume.density(UVec3::new(i % 2, i / 2, 0))).collect()
    };
    assert_eq!(densities(&path), [1.0, 2.0, 300.0, -4.0]);
    let path = folder.path().join("text.vti");
    let text = "<VTKFile type=\"ImageData\" byte_order=\"BigEndian\"><ImageData WholeExtent=\"0 1 0 1 0 0\">\
                <Piece Extent=\"0 1 0 1 0 0\"><PointData><DataArray type=\"Int16\" Name=\"a\" format=\"ascii\">\
                1 2 300 -4</DataArray></PointData></Piece></ImageData></VTKFile>";
    std::fs::write(&path, text).unwrap();
    assert_eq!(densities(&path), [1.0, 2.0, 300.0, -4.0]);
}

#[test]
fn dicom_of_two_phases_is_one_of_them() {
    let folder = fixture("10_dicom_two_phases_restart");
    let notes = &["its times, phases or echoes: 2"];
    let right = || Right { dims: Some([24, 10, 20]), count: Some(720), notes, ..Right::default() };
    check(folder.clone(), right());
    let half = |path: &Path| {
        let contents = load(path, &ImportOptions::default()).unwrap().contents;
        let lefts = voxels(&contents).iter().filter(|(v, _)| v.x < 12).count();
        assert!(lefts == 0 || lefts == 720, "{}: {lefts}", path.display());
        lefts == 0
    };
    // The opened file decides.
    let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let halves: Vec<bool> = files.map(|path| half(&path)).collect();
    assert_eq!(halves.iter().filter(|is_right| **is_right).count(), 10);
}

#[test]
fn dicom_without_a_mark_or_under_another_header() {
    for name in ["11_dicom_no_preamble", "12_dicom_vr_mismatch"] {
        let right = || Right { file_dims: Some([24, 20, 6]), count: Some(432), ..Right::default() };
        check(fixture(name), right());
        check(fixture(name).join("s3.dcm"), right());
    }
}

#[test]
fn dicom_of_other_programs_without_a_mark_or_under_another_header() {
    for name in
        ["11_dicom_no_preamble_real_no_meta.dcm", "12_dicom_vr_mismatch_real_SC_rgb_jpeg.dcm"]
    {
        check(foreign(name), Right::default());
    }
}

#[test]
fn dicom_padding_is_no_density() {
    let path = fixture("13_dicom_padding");
    let info = format::info(&path).unwrap();
    let threshold = info.densities.unwrap().threshold;
    assert!(threshold > -1000.0 && threshold < 40.0, "{threshold}");
    check(path, Right { notes: &["PixelPaddingValue"], ..Right::default() });
}

#[test]
fn meta_images_and_legacy_vtk() {
    check(fixture("26_scan.mha"), Right { voxel: FINE, is_silent: true, ..scan() });
    check(fixture("26_scan_legacy.vtk"), Right { voxel: FINE, is_silent: true, ..scan() });
    let folder = tempfile::tempdir().unwrap();
    let file = std::fs::read(fixture("26_scan.mha")).unwrap();
    let begin = file.windows(5).position(|part| part == b"LOCAL").unwrap();
    let header = [&file[..begin], b"scan.raw\n"].concat();
    std::fs::write(folder.path().join("scan.mhd"), header).unwrap();
    std::fs::write(folder.path().join("scan.raw"), &file[begin + 6..]).unwrap();
    check(folder.path().join("scan.mhd"), Right { voxel: FINE, is_silent: true, ..scan() });
}

#[test]
fn pairs_of_header_and_voxels_packed_or_opened_by_either() {
    for name in ["nii_pairgz.hdr.gz", "nii_pairgz.img.gz", "nii_pair.img", "nii_pair.hdr"] {
        check(fixture(name), scan());
    }
    let folder = tempfile::tempdir().unwrap();
    let alone = folder.path().join("alone.img");
    std::fs::copy(fixture("nii_pair.img"), &alone).unwrap();
    refused(alone.clone(), &["not beside it", "layout"]);
    // Voxels alone, under any name.
    let layout: RawLayout = "24x20x10:i16le".parse().unwrap();
    let options =
        |layout| ImportOptions { raw: Some(layout), existence: DENSE, ..Default::default() };
    for name in ["alone.img", "scan.dat", "scan", "scan.raw.bin"] {
        let path = folder.path().join(name);
        std::fs::copy(fixture("nii_pair.img"), &path).unwrap();
        assert_eq!(
            load(&path, &options(layout)).unwrap().contents.grid.opaque_count(),
            780,
            "{name}"
        );
    }
}

#[test]
fn packed_files_are_told_to_be_unpacked_whatever_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let mut tar = vec![0; 1024];
    tar[257..262].copy_from_slice(b"ustar");
    for (name, start, part) in [
        ("mesh.stl.gz", &[0x1F, 0x8B, 8, 0][..], "gzip"),
        ("scan.nrrd.zip", b"PK\x03\x04", "ZIP"),
        ("scan.raw.tar", &tar, "a tar archive"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, start).unwrap();
        refused(path, &[part, "unpack"]);
    }
}

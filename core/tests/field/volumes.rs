//! Tests the selection among several channels, times, phases or volumes of a scan, with files whose voxels hold the
//! number of their volume; see `mod.rs`.

use std::io::Write;

use sculpture_core::format::options::Ordinal;
use sculpture_core::format::{ChosenVolume, Info, info_with, load_volume};

use super::*;

/// Returns options that request a channel and a time; 0 leaves one open.
fn asked(channel: u32, time: u32) -> ImportOptions {
    let (channel, time) = (Ordinal::new(channel), Ordinal::new(time));
    ImportOptions { channel, time, ..ImportOptions::default() }
}

fn told(path: &Path, options: &ImportOptions) -> Result<Info, String> {
    info_with(path, options, &Limits::default(), &()).map_err(|error| error.to_string())
}

/// Returns the first voxels of all layers.
fn layers(path: &Path, options: &ImportOptions) -> Result<Vec<f32>, String> {
    let volume = load_volume(path, options, &Limits::default(), &());
    let volume = volume.map_err(|error| error.to_string())?;
    Ok((0..volume.dims.z).map(|z| volume.density(UVec3::new(0, 0, z)).unwrap()).collect())
}

#[test]
fn channels_and_times_of_hyperstacks_are_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let path = numbered_pages(
        folder.path(),
        12,
        "ImageJ=1.54f\nimages=12\nchannels=2\nslices=3\nframes=2\n",
    );
    for (channel, time, first) in [(1, 1, 0.0), (2, 1, 1.0), (1, 2, 6.0), (2, 2, 7.0), (0, 2, 6.0)]
    {
        let right = [first, first + 2.0, first + 4.0];
        assert_eq!(layers(&path, &asked(channel, time)).unwrap(), right, "{channel} {time}");
    }
    assert_eq!(layers(&path, &asked(0, 0)), layers(&path, &asked(1, 1)));
    let error = layers(&path, &asked(3, 1)).unwrap_err();
    assert_eq!(error, "channel 3 was asked for, but the file has 2; choose one from 1 to 2");
    let error = layers(&path, &asked(1, 9)).unwrap_err();
    assert_eq!(error, "time 9 was asked for, but the file has 2; choose one from 1 to 2");

    let open = told(&path, &asked(0, 2)).unwrap();
    assert_eq!(open.volumes.channel, ChosenVolume { number: 1, count: 2 });
    assert_eq!(open.volumes.time, ChosenVolume { number: 2, count: 2 });
    assert!(open.to_string().contains("channels: 2, read: 1\ntimes: 2, read: 2\n"), "{open}");
    let note = "its channels: 2; the first was taken; the option `channel` takes another";
    assert_eq!(open.notes, [note]);
    assert!(told(&path, &asked(2, 1)).unwrap().notes.is_empty(), "it was asked for");
    assert_eq!(told(&path, &asked(2, 1)).unwrap().densities.unwrap().histogram.max, 5.0);
}

#[test]
fn times_without_layers_are_layers_unless_one_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = numbered_pages(folder.path(), 6, "ImageJ=1.54f\nimages=6\nchannels=2\nframes=3\n");
    assert_eq!(layers(&path, &asked(0, 0)).unwrap(), [0.0, 2.0, 4.0]);
    assert_eq!(layers(&path, &asked(2, 0)).unwrap(), [1.0, 3.0, 5.0]);
    assert_eq!(layers(&path, &asked(2, 3)).unwrap(), [5.0]);
    assert!(layers(&path, &asked(2, 4)).unwrap_err().contains("has 3"));
    // A note that does not match the file.
    let path = numbered_pages(folder.path(), 3, "ImageJ=1.54f\nimages=8\nchannels=2\nslices=4\n");
    assert_eq!(layers(&path, &asked(0, 0)).unwrap(), [0.0, 1.0, 2.0]);
    let error = layers(&path, &asked(2, 0)).unwrap_err();
    assert!(error.contains("speaks of 8 pages, but has 3"), "{error}");
    // Pages without a note.
    let path = numbered_pages(folder.path(), 3, "");
    assert_eq!(layers(&path, &asked(1, 1)).unwrap(), [0.0, 1.0, 2.0]);
    let error = layers(&path, &asked(0, 2)).unwrap_err();
    assert_eq!(error, "time 2 was asked for, but the file has only one; leave the option out");
}

#[test]
fn channels_and_times_of_ome_are_chosen_in_its_order() {
    let folder = tempfile::tempdir().unwrap();
    let file = |order: &str, blocks: &str| {
        let text = format!(
            "<OME UUID='urn:uuid:1'><Image><Pixels DimensionOrder='{order}' SizeX='3' SizeY='2' SizeZ='2' SizeC='2' \
             SizeT='2'>{blocks}</Pixels></Image></OME>"
        );
        numbered_pages(folder.path(), 8, &text)
    };
    for (order, right) in [("XYCZT", [5.0, 7.0]), ("XYZCT", [6.0, 7.0]), ("XYTCZ", [3.0, 7.0])] {
        let path = file(order, "");
        assert_eq!(layers(&path, &asked(2, 2)).unwrap(), right, "{order}");
        assert!(layers(&path, &asked(3, 2)).unwrap_err().contains("has 2"), "{order}");
    }
    // A set of files, of which this one has the second channel.
    let elsewhere = "<UUID FileName='b'>urn:uuid:2</UUID>";
    let blocks = format!(
        "<TiffData IFD='0' FirstC='0' PlaneCount='4'>{elsewhere}</TiffData>\
         <TiffData IFD='0' FirstC='1' PlaneCount='4'/>"
    );
    let path = file("XYZTC", &blocks);
    assert_eq!(layers(&path, &asked(2, 2)).unwrap(), [2.0, 3.0]);
    assert_eq!(layers(&path, &asked(0, 0)).unwrap(), [0.0, 1.0]);
    let open = told(&path, &asked(0, 0)).unwrap();
    assert_eq!(open.volumes.channel, ChosenVolume { number: 2, count: 2 });
    assert!(open.notes.iter().any(|note| note.contains("one of them was taken")), "{open}");
    let error = layers(&path, &asked(1, 1)).unwrap_err();
    assert!(error.contains("channel 1 at time 1 is not in this file"), "{error}");
}

#[test]
fn channels_and_times_of_files_as_people_have_them() {
    for (name, option, count) in [
        ("04_tiff_imagej_2channels.tif", asked(2, 0), 180),
        ("04_tiff_imagej_2channels.tif", asked(1, 0), 780),
        ("04_tiff_imagej_2times.tif", asked(0, 1), 780),
    ] {
        let options = ImportOptions { existence: DENSE, ..option };
        let loaded = load(&fixture(name), &options).unwrap();
        assert_eq!(loaded.contents.grid.opaque_count(), count, "{name}");
        assert!(loaded.notes.is_empty(), "{:?}", loaded.notes);
    }
    let [first, second] = [1, 2].map(|time| {
        let options = ImportOptions { existence: DENSE, ..asked(0, time) };
        load(&fixture("04_tiff_imagej_2times.tif"), &options).unwrap().contents
    });
    assert_ne!(first.grid, second.grid);
}

#[test]
fn times_of_a_dicom_series_are_chosen() {
    let folder = fixture("10_dicom_two_phases_restart");
    let half = |path: &Path, time: u32| {
        let loaded = load(path, &asked(0, time)).unwrap();
        assert!(loaded.notes.iter().all(|note| !note.contains("phases")), "{:?}", loaded.notes);
        voxels(&loaded.contents).iter().filter(|(v, _)| v.x < 12).count()
    };
    let halves = [1, 2].map(|time| half(&folder, time));
    assert!(halves == [0, 720] || halves == [720, 0], "{halves:?}");
    // Whichever file is named.
    for file in std::fs::read_dir(&folder).unwrap() {
        let path = file.unwrap().path();
        assert_eq!([1, 2].map(|time| half(&path, time)), halves, "{}", path.display());
    }
    assert!(told(&folder, &asked(0, 3)).unwrap_err().contains("has 2; choose one from 1 to 2"));
    let open = told(&folder, &asked(0, 0)).unwrap();
    assert!(open.to_string().contains("\ntimes: 2, read: 1\n"), "{open}");
}

/// Returns six volumes of two layers of four voxels that hold the number of their volume, one after another.
fn six() -> Vec<u8> {
    (0..6).flat_map(|volume| [volume; 8]).collect()
}

/// Requests each of six volumes, and one more.
fn check_six(path: &Path) {
    let name = path.display();
    for time in 1..=6 {
        let value = time as f32 - 1.0;
        assert_eq!(layers(path, &asked(0, time)).unwrap(), [value; 2], "{name} {time}");
    }
    assert_eq!(layers(path, &asked(0, 0)).unwrap(), [0.0; 2], "{name}");
    assert!(layers(path, &asked(0, 7)).unwrap_err().contains("from 1 to 6"), "{name}");
    assert!(layers(path, &asked(2, 0)).unwrap_err().contains("only one"), "{name}");
    let open = told(path, &asked(0, 0)).unwrap();
    assert!(open.to_string().contains("\ntimes: 6, read: 1\n"), "{name}: {open}");
    let note = "first of 6 volumes taken; the option `time` takes another";
    assert!(open.notes.iter().any(|own| own == note), "{name}: {:?}", open.notes);
    let chosen = told(path, &asked(0, 6)).unwrap();
    assert!(chosen.notes.iter().all(|own| !own.contains("volumes")), "{name}: {:?}", chosen.notes);
}

#[test]
fn volumes_of_nifti_are_chosen() {
    let mut header = vec![0u8; 352];
    header[..4].copy_from_slice(&348i32.to_le_bytes());
    // Two by two by two, then two and three.
    for (i, size) in [5i16, 2, 2, 2, 2, 3].into_iter().enumerate() {
        header[40 + 2 * i..][..2].copy_from_slice(&size.to_le_bytes());
    }
    header[70..72].copy_from_slice(&2i16.to_le_bytes());
    header[72..74].copy_from_slice(&8i16.to_le_bytes());
    header[108..112].copy_from_slice(&352f32.to_le_bytes());
    header[344..348].copy_from_slice(b"n+1\0");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nii");
    let file = [header, six()].concat();
    std::fs::write(&path, &file).unwrap();
    check_six(&path);
    let path = folder.path().join("a.nii.gz");
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(&file).unwrap();
    std::fs::write(&path, packer.finish().unwrap()).unwrap();
    check_six(&path);
    std::fs::write(folder.path().join("a.nii"), &file[..file.len() - 1]).unwrap();
    let error = layers(&folder.path().join("a.nii"), &asked(0, 6)).unwrap_err();
    assert!(error.contains("cut"), "{error}");
}

#[test]
fn volumes_of_nrrd_are_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nrrd");
    let write = |sizes: &str, kinds: &str, voxels: &[u8]| {
        let header = format!(
            "NRRD0004\ntype: uint8\ndimension: {}\nsizes: {sizes}\nkinds: {kinds}\nencoding: raw\n\n",
            sizes.split(' ').count()
        );
        std::fs::write(&path, [header.as_bytes(), voxels].concat()).unwrap();
    };
    write("2 2 2 6", "domain domain domain time", &six());
    check_six(&path);
    write("2 2 2 2 3", "domain domain domain list time", &six());
    check_six(&path);
    // The volumes of each voxel interleaved.
    let side_by_side: Vec<u8> = (0..8).flat_map(|_| 0..6).collect();
    write("6 2 2 2", "list domain domain domain", &side_by_side);
    check_six(&path);
    // Three before the voxels, two behind them; the former varies fastest.
    let around: Vec<u8> = (0..2).flat_map(|b| (0..8).flat_map(move |_| 3 * b..3 * b + 3)).collect();
    write("3 2 2 2 2", "list domain domain domain time", &around);
    check_six(&path);
    // Colours.
    let colours: Vec<u8> = (0..2).flat_map(|time| [[time * 100 + 50; 3]; 8].concat()).collect();
    write("3 2 2 2 2", "RGB-color domain domain domain time", &colours);
    for (time, level) in [(1, 50), (2, 150)] {
        let loaded = load(&path, &asked(0, time)).unwrap();
        assert!(voxels(&loaded.contents).iter().all(|(_, rgb)| *rgb == Rgb([level; 3])));
        assert_eq!(loaded.contents.grid.opaque_count(), 8);
    }
}

#[test]
fn volumes_of_a_metaimage_are_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, more: &str, voxels: &[u8]| {
        let path = folder.path().join(name);
        let header = format!("NDims = 4\nDimSize = 2 2 2 6\nElementType = MET_UCHAR\n{more}\n");
        std::fs::write(&path, [header.as_bytes(), voxels].concat()).unwrap();
        path
    };
    check_six(&write("raw.mha", "ElementDataFile = LOCAL", &six()));
    let words: Vec<String> = six().iter().map(u8::to_string).collect();
    let text = "BinaryData = False\nElementDataFile = LOCAL";
    check_six(&write("text.mha", text, words.join("\n ").as_bytes()));
    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(&six()).unwrap();
    let packed = "CompressedData = True\nElementDataFile = LOCAL";
    check_six(&write("packed.mha", packed, &packer.finish().unwrap()));
    // At the end of another file.
    std::fs::write(folder.path().join("a.bin"), [vec![99; 7], six()].concat()).unwrap();
    check_six(&write("end.mhd", "HeaderSize = -1\nElementDataFile = a.bin", &[]));
    let names: String = (0..12).map(|layer| format!("{layer}.bin\n")).collect();
    for layer in 0..12 {
        std::fs::write(folder.path().join(format!("{layer}.bin")), [layer / 2; 4]).unwrap();
    }
    check_six(&write("list.mhd", "ElementDataFile = LIST", names.as_bytes()));
}

#[test]
fn a_file_with_one_volume_has_no_second() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.raw");
    std::fs::write(&path, [9; 8]).unwrap();
    let raw = Some("2x2x2:u8".parse().unwrap());
    assert!(layers(&path, &ImportOptions { raw, ..asked(1, 1) }).is_ok());
    for (channel, time) in [(2, 0), (0, 2)] {
        let error = layers(&path, &ImportOptions { raw, ..asked(channel, time) }).unwrap_err();
        assert!(error.contains("the file has only one"), "{error}");
    }
    let text = "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 1 0 0\"><Piece Extent=\"0 1 0 1 0 0\">\
                <PointData><DataArray type=\"Int16\" Name=\"a\" format=\"ascii\">1 2 3 4</DataArray></PointData></Piece>\
                </ImageData></VTKFile>";
    let path = folder.path().join("a.vti");
    std::fs::write(&path, text).unwrap();
    assert!(layers(&path, &asked(0, 1)).is_ok());
    assert!(layers(&path, &asked(0, 2)).unwrap_err().contains("the file has only one"));
}

//! Video files and folders of pictures, intact and damaged.

use std::path::Path;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use virtual_sculpture::video::{PlaybackState, VideoFrame, VideoSource};

use super::{colour, jpeg, near, open, single_colour, until};

/// The frames seen of a video, and its error.
type Seen = (Vec<VideoFrame>, Option<String>);

fn play(address: &str) -> Seen {
    play_all(&[address.to_owned()]).remove(0)
}

/// Plays films at the same time to their ends.
fn play_all(addresses: &[String]) -> Vec<Seen> {
    let start = Instant::now();
    let mut sources: Vec<VideoSource> = addresses.iter().map(|address| open(address)).collect();
    let mut seen: Vec<Seen> = addresses.iter().map(|_| (Vec::new(), None)).collect();
    let running = |source: &VideoSource| {
        matches!(
            source.state(),
            PlaybackState::Opening | PlaybackState::Live | PlaybackState::Lost(_)
        )
    };
    while sources.iter().any(running) {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
        for (source, (frames, error)) in sources.iter_mut().zip(&mut seen) {
            frames.extend(source.poll().cloned());
            *error = source.state().error().map(ToString::to_string);
        }
    }
    seen
}

/// Slow enough that a busy machine sees every frame.
const SLOWLY: &str = "?loop=no&fps=2";

fn at(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

/// A film of flat pictures: luma rises with the picture's number, colour is Cb 90, Cr 160.
fn y4m(chroma: &str, width: usize, height: usize, pictures: u8) -> Vec<u8> {
    let (w, h) = match chroma {
        "420jpeg" | "420mpeg2" => (width.div_ceil(2), height.div_ceil(2)),
        "422" => (width.div_ceil(2), height),
        "411" => (width.div_ceil(4), height),
        "444" => (width, height),
        _ => (0, 0),
    };
    let mut film = format!("YUV4MPEG2 W{width} H{height} F100:1 Ip A1:1 C{chroma}\n").into_bytes();
    for picture in 0..pictures {
        film.extend(b"FRAME\n");
        film.extend(vec![50 + 30 * picture; width * height]);
        film.extend(vec![90; w * h]);
        film.extend(vec![160; w * h]);
    }
    film
}

fn film_colour(picture: u8, mono: bool) -> [u8; 3] {
    let y = 1.164384 * (f64::from(50 + 30 * picture) - 16.0);
    let (cb, cr) = if mono { (0.0, 0.0) } else { (90.0 - 128.0, 160.0 - 128.0) };
    let rgb = [y + 1.596027 * cr, y - 0.391762 * cb - 0.812968 * cr, y + 2.017232 * cb];
    rgb.map(|v| v.clamp(0.0, 255.0).round() as u8)
}

#[test]
fn uncompressed_films_of_each_kind_come_in_order_and_time() {
    let folder = tempfile::tempdir().unwrap();
    let kinds = ["420jpeg", "420mpeg2", "422", "411", "444", "mono"];
    let addresses = kinds.map(|chroma| {
        // Odd sizes, where the colour planes are rounded up.
        let path = at(folder.path(), &format!("{chroma}.y4m"));
        std::fs::write(&path, y4m(chroma, 37, 23, 4)).unwrap();
        path + SLOWLY
    });
    for (chroma, (frames, error)) in kinds.into_iter().zip(play_all(&addresses)) {
        assert_eq!(error, None);
        assert_eq!(frames.len(), 4, "{chroma}");
        for (picture, frame) in (0..).zip(&frames) {
            assert_eq!((frame.width, frame.height), (37, 23));
            let expected = film_colour(picture, chroma == "mono");
            assert!(near(single_colour(frame, 0), expected, 1), "{chroma} {picture}");
            assert_eq!(frame.position, Duration::from_millis(500 * u64::from(picture)));
            assert_eq!(frame.sequence, u64::from(picture) + 1);
        }
        assert!(frames[3].arrived - frames[0].arrived >= Duration::from_millis(1500));
    }
}

#[test]
fn films_repeat_unless_told_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let path = at(folder.path(), "film.y4m");
    std::fs::write(&path, y4m("444", 8, 8, 2)).unwrap();
    let mut source = open(&path);
    until(&mut source, |s| s.frame().is_some_and(|frame| frame.sequence >= 7));
    assert!(source.state().error().is_none() && source.stats().opened == 1);
}

#[test]
fn a_full_range_film_is_not_stretched() {
    let folder = tempfile::tempdir().unwrap();
    let path = at(folder.path(), "film.y4m");
    let film = [b"YUV4MPEG2 W2 H1 Cmono XCOLORRANGE=FULL\nFRAME\n".as_slice(), &[7, 200]].concat();
    std::fs::write(&path, film).unwrap();
    let first = |address: &str| play(address).0[0].pixels.clone();
    assert_eq!(first(&format!("{path}?loop=no")), [7, 7, 7, 255, 200, 200, 200, 255]);
    // The user's choice overrides the file.
    assert_eq!(first(&format!("{path}?loop=no&range=limited"))[..4], [0, 0, 0, 255]);
}

#[test]
fn jpeg_films_come_in_order_past_a_damaged_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = at(folder.path(), "film.mjpeg");
    let mut film = Vec::new();
    for number in 0..5 {
        let mut picture = jpeg(32, 16, colour(number));
        if number == 2 {
            // A quantisation table of no known number.
            let at = picture.windows(2).position(|w| w == [0xFF, 0xDB]).unwrap();
            picture[at + 4] = 0x0F;
        }
        film.extend(picture);
    }
    // Broken off, as a recording is.
    film.extend(&jpeg(32, 16, colour(9))[..400]);
    std::fs::write(&path, film).unwrap();
    let (frames, error) = play(&(path + SLOWLY));
    assert_eq!(error, None);
    let seen: Vec<[u8; 3]> = frames.iter().map(|frame| single_colour(frame, 2)).collect();
    assert_eq!(seen.len(), 4);
    for (number, seen) in [0, 1, 3, 4].into_iter().zip(seen) {
        assert!(near(seen, colour(number), 4), "{number} {seen:?}");
    }
    assert_eq!(frames[3].position, Duration::from_millis(2000));
}

#[test]
fn folders_of_png_come_in_the_order_of_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    image::RgbImage::from_pixel(6, 5, image::Rgb([10, 20, 30])).save(path("f9.png")).unwrap();
    image::RgbaImage::from_pixel(6, 5, image::Rgba([40, 50, 60, 9])).save(path("f10.png")).unwrap();
    image::GrayImage::from_pixel(6, 5, image::Luma([70])).save(path("f11.PNG")).unwrap();
    let deep = image::ImageBuffer::from_pixel(6, 5, image::Rgb([0x1234_u16, 0x5678, 0x9ABC]));
    deep.save(path("f100.png")).unwrap();
    std::fs::write(path("notes.txt"), "no picture").unwrap();
    let address = format!("{}{SLOWLY}", folder.path().display());
    let (frames, error) = play(&address);
    assert_eq!(error, None);
    let seen: Vec<[u8; 3]> = frames.iter().map(|frame| single_colour(frame, 0)).collect();
    assert_eq!(seen, [[10, 20, 30], [40, 50, 60], [70; 3], [0x12, 0x56, 0x9A]]);

    image::GrayImage::from_pixel(6, 6, image::Luma([70])).save(path("f200.png")).unwrap();
    let (frames, error) = play(&address);
    let error = error.unwrap();
    assert!(error.contains("f200.png") && error.contains("6 x 6") && error.contains("6 x 5"));
    assert_eq!(frames.len(), 4);
}

#[test]
fn damaged_films_say_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let whole = y4m("420jpeg", 16, 16, 3);
    let frame_len = 16 * 16 * 3 / 2 + 6;
    let png = folder.path().join("shots");
    std::fs::create_dir(&png).unwrap();
    std::fs::write(png.join("1.png"), b"\x89PNG\r\n\x1a\nnonsense").unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let files: [(&str, Vec<u8>, &str); 12] = [
        ("cut.y4m", whole[..whole.len() - 7].to_vec(), "picture 3 is truncated"),
        ("tag.y4m", [&whole[..whole.len() - frame_len], b"FROME\nxx"].concat(), "picture 3"),
        ("only.y4m", b"YUV4MPEG2 W16 H16\n".to_vec(), "no pictures"),
        ("none.y4m", Vec::new(), "not a YUV4MPEG2"),
        ("huge.y4m", b"YUV4MPEG2 W4000000000 H4000000000\nFRAME\n".to_vec(), "4000000000"),
        ("wide.y4m", b"YUV4MPEG2 W8192 H8192\nFRAME\n".to_vec(), "8192"),
        ("zero.y4m", b"YUV4MPEG2 W0 H5\nFRAME\n".to_vec(), "0 x 5"),
        ("deep.y4m", b"YUV4MPEG2 W5 H5 C420p10\nFRAME\n".to_vec(), "C420p10"),
        ("line.y4m", vec![b'Y'; 100_000], "header line"),
        ("none.mjpeg", Vec::new(), "no complete JPEG"),
        ("text.mjpeg", b"no picture in here".to_vec(), "no complete JPEG"),
        ("cut.mjpg", jpeg(16, 16, [1, 2, 3])[..300].to_vec(), "no complete JPEG"),
    ];
    for (name, bytes, why) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
        let (frames, error) = play(&at(folder.path(), name));
        let error = error.unwrap();
        assert!(error.contains(why) && error.contains(name), "{name}: {error}");
        assert_eq!(frames.is_empty(), !matches!(name, "cut.y4m" | "tag.y4m"), "{name}");
    }
    for (name, why) in [
        ("shots", "broken PNG"),
        ("empty", "no PNG"),
        ("missing", "No such file"),
        ("missing.y4m", "No such file"),
    ] {
        let error = play(&at(folder.path(), name)).1.unwrap();
        assert!(error.contains(why) && error.contains(name), "{name}: {error}");
    }
    let folder_as_film = at(folder.path(), "empty.y4m");
    std::fs::create_dir(&folder_as_film).unwrap();
    assert!(play(&folder_as_film).1.unwrap().contains("not a regular file"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn mutated_films_end_or_fail(
        kind in 0usize..3,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20),
        keep in 0.1f64..1.0,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let (name, mut bytes) = match kind {
            0 => ("a.y4m", y4m("420jpeg", 9, 7, 2)),
            1 => ("a.mjpeg", [jpeg(16, 16, [9; 3]), jpeg(24, 8, [90; 3])].concat()),
            _ => {
                let mut png = std::io::Cursor::new(Vec::new());
                let picture = image::GrayImage::from_pixel(9, 9, image::Luma([3]));
                picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
                ("a.png", png.into_inner())
            }
        };
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        bytes.truncate((bytes.len() as f64 * keep) as usize);
        std::fs::write(folder.path().join(name), bytes).unwrap();
        let path = if kind == 2 { folder.path().display().to_string() } else { at(folder.path(), name) };
        let (frames, error) = play(&format!("{path}?loop=no&fps=1000"));
        prop_assert!(!frames.is_empty() || error.is_some());
        for frame in frames {
            prop_assert_eq!(frame.pixels.len(), (frame.width * frame.height * 4) as usize);
        }
    }
}

#[test]
fn three_buffers_go_round() {
    // Big pictures as fast as the thread can make them, and a reader that asks all the time.
    let folder = tempfile::tempdir().unwrap();
    let path = at(folder.path(), "film.y4m");
    std::fs::write(&path, y4m("420jpeg", 640, 480, 5)).unwrap();
    let mut source = open(&format!("{path}?fps=1000"));
    let (mut last, mut frames) = (0, 0);
    let mut buffers = std::collections::HashSet::new();
    let end = Instant::now() + Duration::from_secs(2);
    while Instant::now() < end {
        if let Some(frame) = source.poll() {
            assert!(frame.sequence > last);
            assert_eq!((frame.width, frame.height), (640, 480));
            single_colour(frame, 0);
            last = frame.sequence;
            frames += 1;
            buffers.insert(frame.pixels.as_ptr());
        }
    }
    // Three buffers are reused for ever, whatever the two threads do.
    assert!(frames > 3 && buffers.len() <= 3, "{frames} frames, {} buffers", buffers.len());
}

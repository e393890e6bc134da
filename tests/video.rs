//! Sources of video from outside: films and a phone as files and sockets really give them, and
//! the same damaged.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use jpeg_encoder::{ColorType, Encoder};
use proptest::prelude::*;
use virtual_sculpture::video::{Address, Frame, State, VideoSource};

fn open(address: &str) -> VideoSource {
    VideoSource::open(&address.parse().unwrap()).unwrap()
}

/// Polls until `done`, for a minute at most.
fn until(source: &mut VideoSource, done: impl Fn(&VideoSource) -> bool) {
    let start = Instant::now();
    while !done(source) {
        assert!(start.elapsed() < Duration::from_secs(60), "{:?}", source.state());
        std::thread::sleep(Duration::from_millis(1));
        source.poll();
    }
}

/// Plays to the end and gives every frame that was seen, and what was wrong.
fn play(address: &str) -> (Vec<Frame>, Option<String>) {
    let mut source = open(address);
    let (start, mut frames) = (Instant::now(), Vec::new());
    loop {
        if let Some(frame) = source.poll() {
            frames.push(frame.clone());
        }
        match source.state() {
            State::Ended => return (frames, None),
            State::Failed(error) => return (frames, Some(error.to_string())),
            State::Opening | State::Live | State::Lost(_) => {}
        }
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn at(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

/// The colour of the middle, and that all others are within `slack` of it.
fn single_colour(frame: &Frame, slack: u8) -> [u8; 3] {
    let pixels = frame.pixels.as_chunks::<4>().0;
    assert_eq!(pixels.len(), (frame.width * frame.height) as usize);
    let [r, g, b, _] = pixels[pixels.len() / 2];
    for [r2, g2, b2, a] in pixels {
        assert!(*a == 255 && r2.abs_diff(r).max(g2.abs_diff(g)).max(b2.abs_diff(b)) <= slack);
    }
    [r, g, b]
}

fn near(a: [u8; 3], b: [u8; 3], slack: u8) -> bool {
    (0..3).all(|i| a[i].abs_diff(b[i]) <= slack)
}

/// Colours that a picture's number stands for, far apart.
fn colour(number: u8) -> [u8; 3] {
    [number % 4 * 60 + 30, number / 4 % 4 * 60 + 30, number / 16 % 4 * 60 + 30]
}

fn jpeg(width: u16, height: u16, rgb: [u8; 3]) -> Vec<u8> {
    let pixels = rgb.repeat(usize::from(width) * usize::from(height));
    let mut bytes = Vec::new();
    Encoder::new(&mut bytes, 95).encode(&pixels, width, height, ColorType::Rgb).unwrap();
    bytes
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
    for chroma in ["420jpeg", "420mpeg2", "422", "411", "444", "mono"] {
        // Odd sizes, where the colour planes are rounded up.
        let path = at(folder.path(), &format!("{chroma}.y4m"));
        std::fs::write(&path, y4m(chroma, 37, 23, 4)).unwrap();
        // Slowly, so that each frame is seen.
        let (frames, error) = play(&format!("{path}?loop=no&fps=10"));
        assert_eq!(error, None);
        assert_eq!(frames.len(), 4, "{chroma}");
        for (picture, frame) in (0..).zip(&frames) {
            assert_eq!((frame.width, frame.height), (37, 23));
            let expected = film_colour(picture, chroma == "mono");
            assert!(near(single_colour(frame, 0), expected, 1), "{chroma} {picture}");
            assert_eq!(frame.position, Duration::from_millis(100 * u64::from(picture)));
            assert_eq!(frame.sequence, u64::from(picture) + 1);
        }
        assert!(frames[3].arrived - frames[0].arrived >= Duration::from_millis(300));
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
    // What a person says goes before what the film says.
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
    let (frames, error) = play(&format!("{path}?loop=no&fps=10"));
    assert_eq!(error, None);
    let seen: Vec<[u8; 3]> = frames.iter().map(|frame| single_colour(frame, 2)).collect();
    assert_eq!(seen.len(), 4);
    for (number, seen) in [0, 1, 3, 4].into_iter().zip(seen) {
        assert!(near(seen, colour(number), 4), "{number} {seen:?}");
    }
    assert_eq!(frames[3].position, Duration::from_millis(400));
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
    let address = format!("{}?loop=no&fps=10", folder.path().display());
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
        ("cut.y4m", whole[..whole.len() - 7].to_vec(), "picture 3 breaks off"),
        ("tag.y4m", [&whole[..whole.len() - frame_len], b"FROME\nxx"].concat(), "picture 3"),
        ("only.y4m", b"YUV4MPEG2 W16 H16\n".to_vec(), "no pictures"),
        ("none.y4m", Vec::new(), "no YUV4MPEG2"),
        ("huge.y4m", b"YUV4MPEG2 W4000000000 H4000000000\nFRAME\n".to_vec(), "4000000000"),
        ("wide.y4m", b"YUV4MPEG2 W8192 H8192\nFRAME\n".to_vec(), "8192"),
        ("zero.y4m", b"YUV4MPEG2 W0 H5\nFRAME\n".to_vec(), "0 x 5"),
        ("deep.y4m", b"YUV4MPEG2 W5 H5 C420p10\nFRAME\n".to_vec(), "C420p10"),
        ("line.y4m", vec![b'Y'; 100_000], "header line"),
        ("none.mjpeg", Vec::new(), "not one whole"),
        ("text.mjpeg", b"no picture in here".to_vec(), "not one whole"),
        ("cut.mjpg", jpeg(16, 16, [1, 2, 3])[..300].to_vec(), "not one whole"),
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
        ("empty", "without PNG"),
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

/// What the server sends next over its present connection.
enum Send {
    Bytes(Vec<u8>),
    /// Close it and wait for the next.
    Close,
}

/// A phone: answers each connection with `head` and then what it is told.
struct Phone {
    port: u16,
    send: Sender<Send>,
    requests: Receiver<Vec<String>>,
    thread: Option<JoinHandle<()>>,
}

impl Phone {
    fn new(head: &'static str) -> Phone {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let (send, orders) = mpsc::channel();
        let (note, requests) = mpsc::channel();
        let thread = std::thread::spawn(move || serve(&listener, head, &orders, &note));
        Phone { port, send, requests, thread: Some(thread) }
    }

    fn bytes(&self, bytes: Vec<u8>) {
        self.send.send(Send::Bytes(bytes)).unwrap();
    }

    fn close(&self) {
        self.send.send(Send::Close).unwrap();
    }

    fn address(&self) -> String {
        format!("http://127.0.0.1:{}/video", self.port)
    }
}

impl Drop for Phone {
    fn drop(&mut self) {
        // Ends the wait for orders, then that for a connection.
        self.send = mpsc::channel().0;
        let _ = TcpStream::connect(("127.0.0.1", self.port));
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn serve(listener: &TcpListener, head: &str, orders: &Receiver<Send>, note: &Sender<Vec<String>>) {
    while let Ok((mut stream, _)) = listener.accept() {
        let lines = BufReader::new(stream.try_clone().unwrap()).lines();
        let request: Vec<String> =
            lines.map_while(Result::ok).take_while(|line| !line.is_empty()).collect();
        let _ = note.send(request);
        let mut open = stream.write_all(head.as_bytes()).is_ok();
        while open {
            match orders.recv() {
                Ok(Send::Bytes(bytes)) => open = stream.write_all(&bytes).is_ok(),
                Ok(Send::Close) => open = false,
                Err(_) => return,
            }
        }
    }
}

const MULTIPART: &str = "HTTP/1.0 200 OK\r\nServer: phone\r\n\
    Content-Type: multipart/x-mixed-replace; boundary=--cut\r\n\r\n--cut\r\n";

fn part(jpeg: &[u8]) -> Vec<u8> {
    let head = format!("Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.len());
    [head.as_bytes(), jpeg, b"\r\n--cut\r\n"].concat()
}

#[test]
fn a_phone_that_goes_and_comes_back() {
    let phone = Phone::new(MULTIPART);
    let mut source = open(&phone.address());
    for number in 1..=3 {
        phone.bytes(part(&jpeg(32, 32, colour(number))));
        until(&mut source, |s| s.frame().is_some_and(|frame| frame.sequence == u64::from(number)));
        assert!(near(single_colour(source.frame().unwrap(), 2), colour(number), 4));
        assert!(matches!(source.state(), State::Live));
    }
    let request = phone.requests.recv().unwrap();
    assert_eq!(request[0], "GET /video HTTP/1.1");
    assert!(request.contains(&format!("Host: 127.0.0.1:{}", phone.port)), "{request:?}");
    // It goes in the middle of a picture.
    phone.bytes(part(&jpeg(32, 32, colour(9)))[..300].to_vec());
    phone.close();
    until(&mut source, |s| matches!(s.state(), State::Lost(_)));
    assert!(source.state().error().unwrap().to_string().contains("closed the connection"));
    assert!(near(single_colour(source.frame().unwrap(), 2), colour(3), 4));
    // It is there again, turned by a quarter.
    phone.bytes(part(&jpeg(16, 48, colour(5))));
    until(&mut source, |s| s.frame().is_some_and(|frame| frame.sequence == 4));
    let frame = source.frame().unwrap();
    assert_eq!((frame.width, frame.height), (16, 48));
    assert!(near(single_colour(frame, 2), colour(5), 4));
    assert!(matches!(source.state(), State::Live) && source.stats().opened == 2);
}

#[test]
fn a_phone_that_is_switched_on_later() {
    // A port that was free a moment ago.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let mut source = open(&format!("http://me:secret@{address}/"));
    until(&mut source, |s| matches!(s.state(), State::Lost(_)));
    let text = source.state().error().unwrap().to_string();
    assert!(text.contains("refused") && !text.contains("secret"), "{text}");
    let listener = TcpListener::bind(address).unwrap();
    let (note, requests) = mpsc::channel();
    let (send, orders) = mpsc::channel();
    let thread = std::thread::spawn(move || serve(&listener, MULTIPART, &orders, &note));
    send.send(Send::Bytes(part(&jpeg(8, 8, colour(1))))).unwrap();
    until(&mut source, |s| s.frame().is_some());
    assert!(requests.recv().unwrap().contains(&"Authorization: Basic bWU6c2VjcmV0".to_owned()));
    drop(send);
    drop(source);
    thread.join().unwrap();
}

#[test]
fn chunked_answers_without_lengths_in_small_pieces() {
    let phone = Phone::new(
        "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\
         Content-Type: multipart/x-mixed-replace;boundary=\"b\"\r\n\r\n",
    );
    let mut source = open(&phone.address());
    for number in 1..=2 {
        let picture = jpeg(40, 24, colour(number));
        let bytes = [b"--b\r\nContent-Type: image/jpeg\r\n\r\n", &picture[..], b"\r\n"].concat();
        for piece in bytes.chunks(97) {
            phone.bytes([format!("{:x}\r\n", piece.len()).as_bytes(), piece, b"\r\n"].concat());
        }
        // Known to be whole by its own end, not by the next boundary.
        until(&mut source, |s| s.frame().is_some_and(|frame| frame.sequence == u64::from(number)));
        assert!(near(single_colour(source.frame().unwrap(), 2), colour(number), 4));
    }
    phone.bytes(b"0\r\n\r\n".to_vec());
    until(&mut source, |s| matches!(s.state(), State::Lost(_)));
}

#[test]
fn a_damaged_picture_is_passed_over() {
    let phone = Phone::new(MULTIPART);
    let mut source = open(&phone.address());
    let good = jpeg(32, 32, colour(1));
    phone.bytes(part(&good));
    until(&mut source, |s| s.frame().is_some());
    // Cut in its coded data, then noise, then a good one of another colour.
    phone.bytes(part(&good[..good.len() - 20]));
    phone.bytes([0xFF, 0xD8, 0xFF, 0x00, 1, 2, 3].to_vec());
    phone.bytes(part(&jpeg(32, 32, colour(6))));
    until(&mut source, |s| s.frame().is_some_and(|frame| frame.sequence == 2));
    assert!(near(single_colour(source.frame().unwrap(), 2), colour(6), 4));
    assert_eq!((source.stats().broken, source.stats().opened), (2, 1));
}

#[test]
fn of_a_burst_only_the_newest_picture_is_decoded() {
    let phone = Phone::new(MULTIPART);
    let mut source = open(&phone.address());
    let burst: Vec<u8> = (0..60).flat_map(|number| part(&jpeg(16, 16, colour(number)))).collect();
    phone.bytes(burst);
    let last = colour(59);
    until(&mut source, |s| s.frame().is_some_and(|frame| near(single_colour(frame, 2), last, 4)));
    let stats = source.stats();
    assert_eq!(stats.decoded + stats.stale, 60, "{stats:?}");
    assert!(stats.stale >= 30, "{stats:?}");
}

#[test]
fn answers_that_are_no_video_say_why() {
    for (head, why) in [
        ("HTTP/1.1 404 Not Found\r\n\r\n", "404"),
        ("HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n<html>", "text/html"),
        ("HTTP/1.1 401 Unauthorized\r\n\r\n", "login"),
        ("SSH-2.0-OpenSSH_9.2\r\n\r\n", "not HTTP"),
    ] {
        let phone = Phone::new(head);
        let mut source = open(&phone.address());
        until(&mut source, |s| matches!(s.state(), State::Lost(_)));
        let text = source.state().error().unwrap().to_string();
        assert!(text.contains(why), "{text}");
    }
    // A head without an end.
    let phone = Phone::new("HTTP/1.1 200 OK\r\n");
    for _ in 0..3 {
        phone.bytes(
            b"X-Padding: aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\r\n"
                .repeat(100),
        );
    }
    let mut source = open(&phone.address());
    until(&mut source, |s| matches!(s.state(), State::Lost(_)));
    let text = source.state().error().unwrap().to_string();
    assert!(text.contains("head is longer"), "{text}");
}

#[test]
fn a_reader_is_never_kept_waiting() {
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
    // Three buffers go round for ever, whatever the two threads do.
    assert!(frames > 3 && buffers.len() <= 3, "{frames} frames, {} buffers", buffers.len());
}

#[test]
fn addresses_that_cannot_be() {
    for text in ["", "v4l2:", "https://cam/", "http://", "clip.mp4", "x.y4m?speed=3"] {
        let error = text.parse::<Address>().unwrap_err().to_string();
        assert!(error.contains("video address"), "{error}");
    }
    let mut source = open("v4l2:/dev/no-such-camera");
    if cfg!(target_os = "linux") {
        until(&mut source, |s| matches!(s.state(), State::Lost(_)));
        assert!(source.state().error().unwrap().to_string().contains("/dev/no-such-camera"));
    }
}

//! Streams of a camera over HTTP, damaged in thousands of ways, the same in every run: nothing panics, no frame is
//! larger than allowed, and the source is there for the next one. `VS_FUZZ_RUNS=N` makes it N answers.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use virtual_sculpture::video::{MAX_PIXELS, PlaybackState};

use super::{colour, jpeg, open};

struct Dice(u64);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 33) % end.max(1) as u64) as usize
    }
}

const WORDS: [&[u8]; 12] = [
    b"\r\n",
    b"\r\n\r\n",
    b"--cut",
    b"Content-Length: 18446744073709551615\r\n",
    b"0",
    b"-1",
    b"99999999999",
    b"\xff\xd8",
    b"\xff\xd9",
    b"\xff\xc0\x00\x11\x08\xff\xff\xff\xff\x03",
    b"\0",
    b"Transfer-Encoding: chunked\r\n",
];

fn damage(bytes: &mut Vec<u8>, dice: &mut Dice) {
    for _ in 0..1 + dice.below(4) {
        let reach = if dice.below(2) == 0 { bytes.len().min(400) } else { bytes.len() };
        let at = dice.below(reach);
        let rest = bytes.len() - at;
        match dice.below(6) {
            0 if rest > 0 => bytes[at] ^= 1 << dice.below(8),
            1 if rest > 0 => bytes[at] = [0, 0xff, 0x7f, 0x80][dice.below(4)],
            2 => bytes.truncate(at),
            3 if rest > 0 => drop(bytes.drain(at..at + 1 + dice.below(rest.min(60)))),
            4 if rest > 0 => {
                let chunk = bytes[at..at + 1 + dice.below(rest.min(200))].to_vec();
                let to = dice.below(bytes.len());
                bytes.splice(to..to, chunk);
            }
            _ => drop(bytes.splice(at..at, WORDS[dice.below(WORDS.len())].iter().copied())),
        }
    }
}

/// An answer with three pictures.
fn answer() -> Vec<u8> {
    let mut bytes = b"HTTP/1.1 200 OK\r\nServer: phone\r\nContent-Type: multipart/x-mixed-replace; boundary=--cut\r\n\r\n\
        --cut\r\n"
        .to_vec();
    for number in 1..=3 {
        let jpeg = jpeg(32, 16, colour(number));
        let head = format!("Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", jpeg.len());
        bytes.extend([head.as_bytes(), &jpeg, b"\r\n--cut\r\n"].concat());
    }
    bytes
}

#[test]
fn damaged_answers_of_a_camera_do_no_harm() {
    let runs = std::env::var("VS_FUZZ_RUNS").map_or(150, |runs| runs.parse().unwrap());
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let served: &AtomicUsize = Box::leak(Box::new(AtomicUsize::new(0)));
    std::thread::spawn(move || {
        let intact = answer();
        while let Ok((mut stream, _)) = listener.accept() {
            let run = served.load(Ordering::Relaxed);
            let mut lines = BufReader::new(stream.try_clone().unwrap()).lines();
            while lines.next().is_some_and(|line| line.is_ok_and(|line| !line.is_empty())) {}
            let mut bytes = intact.clone();
            if run < runs {
                damage(&mut bytes, &mut Dice(run as u64 ^ 0x5eed_cafe));
            }
            let _ = stream.write_all(&bytes);
            served.fetch_add(1, Ordering::Relaxed);
        }
    });
    // A source waits longer with every failure: another one is there at once.
    let mut frames = 0;
    while served.load(Ordering::Relaxed) <= runs {
        let before = served.load(Ordering::Relaxed);
        let mut source = open(&format!("http://127.0.0.1:{port}/video"));
        let start = Instant::now();
        let mut last = None;
        while !matches!(source.state(), PlaybackState::Lost(_)) {
            assert!(start.elapsed() < Duration::from_secs(60), "{before}: {:?}", source.state());
            source.poll();
            if let Some(frame) = source.frame() {
                assert!(u64::from(frame.width) * u64::from(frame.height) <= MAX_PIXELS, "{before}");
                assert_eq!(frame.pixels.len(), (4 * frame.width * frame.height) as usize);
                last = Some(frame.sequence);
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        if let Some(error) = source.state().error() {
            let text = error.to_string();
            assert!(
                !text.contains("panic") && !text.chars().any(char::is_control),
                "{before}: {text:?}"
            );
        }
        frames += usize::from(last.is_some());
    }
    assert!(frames > runs / 20, "{frames} of {runs} answers had a picture");
    trials::note!("{runs} answers, {frames} with a picture");
}

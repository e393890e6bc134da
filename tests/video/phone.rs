//! A phone as camera: a small HTTP server that sends, breaks off and comes back as it is told.

use std::io::{BufRead, BufReader, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::JoinHandle;

use virtual_sculpture::video::PlaybackState;

use super::{colour, jpeg, near, open, single_colour, until};

/// The next bytes of the server over its present connection.
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
        assert!(matches!(source.state(), PlaybackState::Live));
    }
    let request = phone.requests.recv().unwrap();
    assert_eq!(request[0], "GET /video HTTP/1.1");
    assert!(request.contains(&format!("Host: 127.0.0.1:{}", phone.port)), "{request:?}");
    // It goes in the middle of a picture.
    phone.bytes(part(&jpeg(32, 32, colour(9)))[..300].to_vec());
    phone.close();
    until(&mut source, |s| matches!(s.state(), PlaybackState::Lost(_)));
    assert!(source.state().error().unwrap().to_string().contains("closed the connection"));
    assert!(near(single_colour(source.frame().unwrap(), 2), colour(3), 4));
    // It is there again, turned by a quarter.
    phone.bytes(part(&jpeg(16, 48, colour(5))));
    until(&mut source, |s| s.frame().is_some_and(|frame| frame.sequence == 4));
    let frame = source.frame().unwrap();
    assert_eq!((frame.width, frame.height), (16, 48));
    assert!(near(single_colour(frame, 2), colour(5), 4));
    assert!(matches!(source.state(), PlaybackState::Live) && source.stats().opened == 2);
}

#[test]
fn a_phone_that_is_switched_on_later() {
    // A port that was free a moment ago.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    drop(listener);
    let mut source = open(&format!("http://me:secret@{address}/"));
    until(&mut source, |s| matches!(s.state(), PlaybackState::Lost(_)));
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
    until(&mut source, |s| matches!(s.state(), PlaybackState::Lost(_)));
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
        until(&mut source, |s| matches!(s.state(), PlaybackState::Lost(_)));
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
    until(&mut source, |s| matches!(s.state(), PlaybackState::Lost(_)));
    let text = source.state().error().unwrap().to_string();
    assert!(text.contains("head is longer"), "{text}");
}

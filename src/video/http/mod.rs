//! Network cameras: a phone or server that sends one JPEG after another in an endless HTTP response
//! (`multipart/x-mixed-replace`, or plain MJPEG).
//!
//! Takes a [`Url`], gives decoded frames. The request is written over plain TCP, because HTTP client libraries offer
//! neither a time limit on the silence between two pictures nor a way to skip outdated pictures. Boundaries and lengths
//! between the pictures are ignored: a JPEG delimits itself, its end is known before the next boundary arrives, and
//! phones send wrong lengths.

mod body;
mod url;

use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use super::error::VideoError;
use super::frame::{MAX_COMPRESSED_BYTES, VideoFrame};
use super::jpeg::{self, Splitter};
use super::reader::{Decoded, FETCH_WAIT, Fetched, OwnerWatch, Reader};
use body::{BodyDecoder, BodySpan, MAX_HEAD, ResponseHead};

pub use url::Url;

/// Time limit for connecting to each address of the host.
const CONNECT_WAIT: Duration = Duration::from_secs(2);
/// Time limit for the head of the response.
const HEAD_WAIT: Duration = Duration::from_secs(5);
/// Most bytes read in one fetch to reach a newer picture.
const MAX_CATCH_UP: usize = 16 << 20;

pub struct HttpCamera {
    stream: TcpStream,
    subject: String,
    opened: Instant,
    body: BodyDecoder,
    splitter: Splitter,
    /// Bytes read and not yet used: `buffer[used..filled]`.
    buffer: Vec<u8>,
    used: usize,
    filled: usize,
    picture: Vec<u8>,
}

impl HttpCamera {
    /// Connects, sends the request, and reads the head of the response.
    pub fn open(url: &Url, stop: &OwnerWatch) -> Result<HttpCamera, VideoError> {
        let subject = url.to_string();
        let io = |error: io::Error| VideoError::io(&*subject, error);
        let mut stream = connect(url, stop).map_err(io)?;
        stream.set_read_timeout(Some(FETCH_WAIT)).map_err(io)?;
        stream.set_write_timeout(Some(HEAD_WAIT)).map_err(io)?;
        stream.set_nodelay(true).map_err(io)?;
        let mut request = format!(
            "GET {} HTTP/1.1\r\nHost: {}\r\nAccept: multipart/x-mixed-replace, */*\r\n\
             User-Agent: virtual-sculpture\r\nConnection: close\r\n",
            url.path(),
            url.authority()
        );
        if let Some(authorization) = url.authorization() {
            request.push_str(&format!("Authorization: {authorization}\r\n"));
        }
        request.push_str("\r\n");
        stream.write_all(request.as_bytes()).map_err(io)?;

        let mut buffer = vec![0; 1 << 16];
        let (mut filled, deadline) = (0, Instant::now() + HEAD_WAIT);
        let (head, used) = loop {
            match stream.read(&mut buffer[filled..MAX_HEAD]) {
                Ok(0) => return Err(closed(&subject)),
                Ok(n) => filled += n,
                Err(error) if is_wait(&error) => {}
                Err(error) => return Err(io(error)),
            }
            if let Some(head) = ResponseHead::parse(&buffer[..filled], &subject)? {
                break head;
            }
            if filled == MAX_HEAD {
                let problem = format!("the answer's head is longer than {MAX_HEAD} bytes");
                return Err(VideoError::malformed(&*subject, problem));
            }
            if stop.asked() || Instant::now() > deadline {
                let seconds = HEAD_WAIT.as_secs();
                return Err(VideoError::Silent { subject, seconds });
            }
        };
        head.check(&subject)?;
        Ok(HttpCamera {
            stream,
            subject,
            opened: Instant::now(),
            body: BodyDecoder::new(head.chunked),
            splitter: Splitter::new(),
            buffer,
            used,
            filled,
            picture: Vec::new(),
        })
    }

    /// Splits the bytes read so far. Returns true as soon as a picture is complete.
    fn cut(&mut self) -> Result<bool, VideoError> {
        while self.used < self.filled {
            let bytes = &self.buffer[self.used..self.filled];
            match self.body.next(bytes, &self.subject)? {
                BodySpan::End => return Err(closed(&self.subject)),
                BodySpan::Frame(n) => self.used += n,
                BodySpan::Body(n) => {
                    let (n, whole) = self.splitter.feed(&bytes[..n]);
                    self.body.took(n);
                    self.used += n;
                    if whole {
                        self.splitter.swap_picture(&mut self.picture);
                        return Ok(true);
                    }
                }
            }
        }
        if self.splitter.outside() > MAX_COMPRESSED_BYTES {
            return Err(VideoError::malformed(&*self.subject, "no JPEG pictures arrive"));
        }
        Ok(false)
    }

    /// Reads the arrived bytes, or waits [`FETCH_WAIT`] for some. Returns false if nothing came.
    fn read(&mut self, wait: bool) -> Result<bool, VideoError> {
        // Only called when all bytes are used.
        self.used = 0;
        self.filled = 0;
        let io = |error| VideoError::io(&*self.subject, error);
        if !wait {
            self.stream.set_nonblocking(true).map_err(io)?;
        }
        let result = self.stream.read(&mut self.buffer);
        if !wait {
            self.stream.set_nonblocking(false).map_err(io)?;
        }
        match result {
            Ok(0) => Err(closed(&self.subject)),
            Ok(n) => {
                self.filled = n;
                Ok(true)
            }
            Err(error) if is_wait(&error) => Ok(false),
            Err(error) => Err(io(error)),
        }
    }
}

impl Reader for HttpCamera {
    fn fetch(&mut self) -> Result<Fetched, VideoError> {
        let start = Instant::now();
        let (mut pictures, mut caught_up) = (0, 0);
        loop {
            // With a picture in hand, only check for a newer one.
            let more = match self.cut() {
                Ok(true) => {
                    pictures += 1;
                    continue;
                }
                Ok(false) => self.read(pictures == 0),
                Err(error) => Err(error),
            };
            match more {
                // The picture in hand is good; the next fetch meets the error again.
                Err(error) if pictures == 0 => return Err(error),
                Err(_) | Ok(false) => break,
                Ok(true) => caught_up += self.filled,
            }
            let enough =
                if pictures > 0 { caught_up > MAX_CATCH_UP } else { start.elapsed() > FETCH_WAIT };
            if enough {
                break;
            }
        }
        if pictures == 0 {
            return Ok(Fetched::Idle);
        }
        let broken = self.splitter.take_broken();
        Ok(Fetched::Picture { position: self.opened.elapsed(), stale: pictures - 1, broken })
    }

    fn decode(&mut self, frame: &mut VideoFrame) -> Result<Decoded, VideoError> {
        Ok(jpeg::decode(&self.picture, &self.subject, frame))
    }

    fn rewind(&mut self) -> Result<Duration, VideoError> {
        Err(VideoError::unsupported(&*self.subject, "a camera cannot be rewound"))
    }
}

fn connect(url: &Url, stop: &OwnerWatch) -> io::Result<TcpStream> {
    let addresses: Vec<SocketAddr> = (url.host(), url.port()).to_socket_addrs()?.collect();
    let mut failure = io::Error::new(ErrorKind::NotFound, "the host has no address");
    for address in addresses {
        if stop.asked() {
            break;
        }
        match TcpStream::connect_timeout(&address, CONNECT_WAIT) {
            Ok(stream) => return Ok(stream),
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

fn closed(subject: &str) -> VideoError {
    let error = io::Error::new(ErrorKind::UnexpectedEof, "the camera closed the connection");
    VideoError::io(subject, error)
}

/// Returns whether there is nothing to read at present.
fn is_wait(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

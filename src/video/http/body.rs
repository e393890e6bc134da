//! Decodes an HTTP/1 response: its head, and the chunks of its body, if it has any (RFC 9112).
//!
//! Takes bytes as they arrive, gives the relevant headers and separates body from framing. Does no input or output.

use super::super::error::VideoError;

/// Longest head of a response, bytes.
pub const MAX_HEAD: usize = 16 << 10;
/// Room for the most headers of a head; the shortest is `a:` with its line end.
const MAX_HEADERS: usize = MAX_HEAD / 3;
/// Longest line about a chunk, bytes.
const MAX_CHUNK_LINE: usize = 256;

/// The relevant headers of a response.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct ResponseHead {
    pub status: u16,
    pub content_type: String,
    pub chunked: bool,
    pub location: String,
}

impl ResponseHead {
    /// Parses status line and headers. Returns the head with its number of bytes, after which the body begins; `None`
    /// if more must be read.
    pub fn parse(bytes: &[u8], subject: &str) -> Result<Option<(ResponseHead, usize)>, VideoError> {
        let mut headers = vec![httparse::EMPTY_HEADER; MAX_HEADERS];
        let mut response = httparse::Response::new(&mut headers);
        // Phones are careless about headers; the relevant ones are read nevertheless.
        let parsed = httparse::ParserConfig::default()
            .allow_spaces_after_header_name_in_responses(true)
            .allow_obsolete_multiline_headers_in_responses(true)
            .ignore_invalid_headers_in_responses(true)
            .parse_response(&mut response, bytes)
            .map_err(|_| VideoError::malformed(subject, "the answer is not HTTP/1"))?;
        let httparse::Status::Complete(end) = parsed else { return Ok(None) };
        let mut head =
            ResponseHead { status: response.code.unwrap_or_default(), ..ResponseHead::default() };
        for header in response.headers.iter() {
            let value = String::from_utf8_lossy(header.value).trim().to_owned();
            match header.name.to_ascii_lowercase().as_str() {
                "content-type" => head.content_type = value,
                "location" => head.location = value,
                "transfer-encoding" => {
                    head.chunked = value.to_ascii_lowercase().contains("chunked");
                }
                _ => {}
            }
        }
        Ok(Some((head, end)))
    }

    /// Refuses a response that is not a stream of JPEG pictures.
    pub fn check(&self, subject: &str) -> Result<(), VideoError> {
        let refuse = |problem| Err(VideoError::unsupported(subject, problem));
        match self.status {
            200 => {}
            301 | 302 | 303 | 307 | 308 => {
                return refuse(format!("it has moved to {:?}", clip(&self.location)));
            }
            401 | 403 => {
                return refuse("it needs a login; write http://name:password@host/path".into());
            }
            status => return refuse(format!("the server answers with status {status}")),
        }
        let kind = self.content_type.to_ascii_lowercase();
        if !kind.starts_with("multipart/") && !kind.starts_with("video/x-motion-jpeg") {
            let kind = clip(&self.content_type);
            return refuse(format!("it sends {kind:?}, not multipart/x-mixed-replace"));
        }
        Ok(())
    }
}

/// Returns text from the network, shortened for a message.
fn clip(text: &str) -> String {
    text.chars().take(100).collect()
}

/// Separates the bytes of a body from the framing of its chunks.
#[derive(Clone, Debug)]
pub struct BodyDecoder(BodyDecoderState);

#[derive(Clone, PartialEq, Eq, Debug)]
enum BodyDecoderState {
    /// Not chunked: every byte is body.
    Plain,
    /// In the line before a chunk.
    Size { line: Vec<u8> },
    /// In a chunk.
    Chunk { left: u64 },
    /// Before the line end that follows a chunk.
    ChunkEnd,
    /// After the last chunk.
    Over,
}

/// The kind of the next bytes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BodySpan {
    /// This many bytes belong to the body. Call [`BodyDecoder::took`] with the number of used ones.
    Body(usize),
    /// This many bytes are framing and used up.
    Frame(usize),
    /// The body has ended.
    End,
}

impl BodyDecoder {
    pub fn new(chunked: bool) -> BodyDecoder {
        BodyDecoder(if chunked {
            BodyDecoderState::Size { line: Vec::new() }
        } else {
            BodyDecoderState::Plain
        })
    }

    /// Counts bytes of the body as used.
    pub fn took(&mut self, n: usize) {
        if let BodyDecoderState::Chunk { left } = &mut self.0 {
            *left = left.saturating_sub(n as u64);
            if *left == 0 {
                self.0 = BodyDecoderState::ChunkEnd;
            }
        }
    }

    /// Classifies the beginning of `bytes`, which must not be empty.
    pub fn next(&mut self, bytes: &[u8], subject: &str) -> Result<BodySpan, VideoError> {
        let malformed = |problem| Err(VideoError::malformed(subject, problem));
        match &mut self.0 {
            BodyDecoderState::Plain => Ok(BodySpan::Body(bytes.len())),
            BodyDecoderState::Over => Ok(BodySpan::End),
            BodyDecoderState::Chunk { left } => {
                Ok(BodySpan::Body(usize::try_from(*left).unwrap_or(usize::MAX).min(bytes.len())))
            }
            BodyDecoderState::ChunkEnd => {
                match bytes[0] {
                    b'\r' => {}
                    b'\n' => self.0 = BodyDecoderState::Size { line: Vec::new() },
                    _ => return malformed("a chunk longer than it says"),
                }
                Ok(BodySpan::Frame(1))
            }
            BodyDecoderState::Size { line } => {
                let end = bytes.iter().position(|&b| b == b'\n');
                let n = end.map_or(bytes.len(), |end| end + 1);
                line.extend_from_slice(&bytes[..n]);
                if line.len() > MAX_CHUNK_LINE {
                    return malformed("a chunk's head that does not end");
                }
                if end.is_some() {
                    let text = String::from_utf8_lossy(line);
                    let digits = text.split(';').next().unwrap_or_default().trim();
                    match u64::from_str_radix(digits, 16) {
                        Ok(0) => self.0 = BodyDecoderState::Over,
                        Ok(left) if !digits.starts_with('+') => {
                            self.0 = BodyDecoderState::Chunk { left }
                        }
                        _ => return malformed("a chunk without a size"),
                    }
                }
                Ok(BodySpan::Frame(n))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn body_of(bytes: &[u8], step: usize) -> Result<(Vec<u8>, bool), VideoError> {
        let (mut body, mut out) = (BodyDecoder::new(true), Vec::new());
        for mut piece in bytes.chunks(step) {
            while !piece.is_empty() {
                match body.next(piece, "x")? {
                    BodySpan::End => return Ok((out, true)),
                    BodySpan::Frame(n) => piece = &piece[n..],
                    BodySpan::Body(n) => {
                        // Like a splitter that finds a picture's end in the middle.
                        let n = n.div_ceil(2);
                        out.extend_from_slice(&piece[..n]);
                        body.took(n);
                        piece = &piece[n..];
                    }
                }
            }
        }
        Ok((out, body.0 == BodyDecoderState::Over))
    }

    #[test]
    fn heads_are_judged() {
        let text = b"HTTP/1.0 200 OK\r\nContent-TYPE: multipart/x-mixed-replace;boundary=x\r\n\
                     Transfer-Encoding: Chunked\r\n\r\nbody";
        let (head, end) = ResponseHead::parse(text, "x").unwrap().unwrap();
        assert_eq!(&text[end..], b"body");
        assert!(head.chunked && head.check("x").is_ok());
        for unfinished in 0..end {
            assert_eq!(
                ResponseHead::parse(&text[..unfinished], "x").unwrap(),
                None,
                "{unfinished} bytes"
            );
        }
        // Like careless servers.
        let text =
            b"HTTP/1.1 200\r\nbad header\r\nContent-Type : multipart/x\r\n\xff: \xfe\r\n\r\n";
        let (head, _) = ResponseHead::parse(text, "x").unwrap().unwrap();
        assert_eq!((head.status, head.content_type.as_str()), (200, "multipart/x"));
        for (answer, why) in [
            ("HTTP/1.1 404 Not Found\r\n\r\n", "404"),
            ("HTTP/1.1 401 No\r\n\r\n", "login"),
            ("HTTP/1.1 302 Found\r\nLocation: http://b/c\r\n\r\n", "http://b/c"),
            ("HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n", "text/html"),
            ("HTTP/1.1 200 OK\r\n\r\n", "multipart"),
        ] {
            let (head, _) = ResponseHead::parse(answer.as_bytes(), "x").unwrap().unwrap();
            let error = head.check("x").unwrap_err();
            assert!(error.to_string().contains(why), "{error}");
        }
        for bad in ["ICY 200 OK\r\n\r\n", "HTTP/1.1\r\n\r\n", "HTTP/1.1 abc\r\n\r\n", "\0\r\n\r\n"]
        {
            assert!(ResponseHead::parse(bad.as_bytes(), "x").is_err(), "{bad:?}");
        }
    }

    #[test]
    fn bad_chunks_are_refused() {
        for bad in ["x\r\n", "\r\n", "+3\r\nabc", "3\r\nabcd", "-1\r\n", "fffffffffffffffff\r\n"] {
            assert!(body_of(bad.as_bytes(), 1).is_err(), "{bad:?}");
        }
        assert!(body_of(&[b'1'; 1000], 7).is_err());
    }

    proptest! {
        #[test]
        fn chunks_give_the_body(
            parts in prop::collection::vec(prop::collection::vec(any::<u8>(), 1..40), 0..10),
            step in 1usize..50,
        ) {
            let mut sent = Vec::new();
            for part in &parts {
                sent.extend_from_slice(format!("{:X};note=1\r\n", part.len()).as_bytes());
                sent.extend_from_slice(part);
                sent.extend_from_slice(b"\r\n");
            }
            sent.extend_from_slice(b"0\r\n\r\n");
            prop_assert_eq!(body_of(&sent, step).unwrap(), (parts.concat(), true));
        }

        #[test]
        fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), step in 1usize..50) {
            let _ = body_of(&bytes, step);
            if let Ok(Some((head, _))) = ResponseHead::parse(&bytes, "x") {
                let _ = head.check("x");
            }
        }
    }
}

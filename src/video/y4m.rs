//! Uncompressed films, YUV4MPEG2 as mjpegtools and ffmpeg write them: a header line, then for each
//! picture a line `FRAME` and its planes.
//!
//! Supported: 8 bits, 4:2:0 of any siting, 4:2:2, 4:4:4, 4:1:1 and mono. Interlaced films are shown
//! without deinterlacing.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::time::Duration;

use super::address::FilmAddress;
use super::colour::{Colour, Range};
use super::error::VideoError;
use super::frame::{VideoFrame, check_size};
use super::rate::Rate;
use super::reader::{Decoded, Fetched, Reader};
use super::yuv::{LineBuffers, YuvLayout, YuvPicture, to_rgba};

/// Longest header line, bytes.
const MAX_LINE: usize = 1024;

/// The contents of the header line.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Y4mHeader {
    width: u32,
    height: u32,
    rate: Option<Rate>,
    layout: YuvLayout,
    range: Option<Range>,
}

pub struct Y4m {
    file: BufReader<File>,
    subject: String,
    header: Y4mHeader,
    rate: Rate,
    colour: Colour,
    /// Offset of the first `FRAME`.
    start: u64,
    picture_len: usize,
    picture: Vec<u8>,
    lines: LineBuffers,
    /// Number of pictures fetched.
    index: u64,
}

impl Y4m {
    pub fn open(address: &FilmAddress) -> Result<Y4m, VideoError> {
        let (file, subject) = address.open_file()?;
        let mut file = BufReader::with_capacity(1 << 16, file);
        let line = read_line(&mut file, &subject)?.unwrap_or_default();
        let header = Y4mHeader::parse(&line, &subject)?;
        check_size(u64::from(header.width), u64::from(header.height), &subject)?;
        let (width, height) = (header.width as usize, header.height as usize);
        let picture_len = header.layout.byte_len(height, width).unwrap_or(usize::MAX);
        let said = Colour { range: header.range.unwrap_or(Range::Limited), ..Colour::DEFAULT };
        Ok(Y4m {
            start: line.len() as u64 + 1,
            file,
            header,
            rate: address.rate.or(header.rate).unwrap_or(Rate::DEFAULT),
            colour: address.colour.over(said),
            picture_len,
            picture: Vec::new(),
            lines: LineBuffers::default(),
            index: 0,
            subject,
        })
    }
}

impl Reader for Y4m {
    fn fetch(&mut self) -> Result<Fetched, VideoError> {
        let Some(line) = read_line(&mut self.file, &self.subject)? else {
            return Ok(Fetched::End);
        };
        let number = self.index + 1;
        if line != b"FRAME" && !line.starts_with(b"FRAME ") {
            let problem = format!("no FRAME line before picture {number}");
            return Err(VideoError::malformed(&*self.subject, problem));
        }
        self.picture.clear();
        // Grows with the present data, not with the header's claims.
        let got = (&mut self.file)
            .take(self.picture_len as u64)
            .read_to_end(&mut self.picture)
            .map_err(|error| VideoError::io(&*self.subject, error))?;
        if got < self.picture_len {
            let need = self.picture_len;
            let problem = format!("picture {number} is truncated after {got} of {need} bytes");
            return Err(VideoError::malformed(&*self.subject, problem));
        }
        let position = self.rate.time_of(self.index);
        self.index = number;
        Ok(Fetched::Picture { position, stale: 0, broken: 0 })
    }

    fn decode(&mut self, frame: &mut VideoFrame) -> Result<Decoded, VideoError> {
        let Y4mHeader { width, height, layout, .. } = self.header;
        frame.shape(width, height, &self.subject)?;
        let (width, height) = (width as usize, height as usize);
        let planes = YuvPicture { layout, width, height, stride: width, data: &self.picture };
        to_rgba(planes, self.colour, &mut self.lines, &mut frame.pixels)
            .map_err(|problem| VideoError::malformed(&*self.subject, problem))?;
        Ok(Decoded::Whole)
    }

    fn rewind(&mut self) -> Result<Duration, VideoError> {
        self.file
            .seek(SeekFrom::Start(self.start))
            .map_err(|error| VideoError::io(&*self.subject, error))?;
        let length = self.rate.time_of(self.index);
        self.index = 0;
        Ok(length)
    }
}

/// Returns a line without its end; `None` at the end of the file.
fn read_line(file: &mut impl BufRead, subject: &str) -> Result<Option<Vec<u8>>, VideoError> {
    let mut line = Vec::new();
    file.take(MAX_LINE as u64)
        .read_until(b'\n', &mut line)
        .map_err(|error| VideoError::io(subject, error))?;
    match line.pop() {
        None => Ok(None),
        Some(b'\n') => Ok(Some(line)),
        Some(_) => {
            let problem = format!("a header line longer than {MAX_LINE} bytes");
            Err(VideoError::malformed(subject, problem))
        }
    }
}

impl Y4mHeader {
    fn parse(line: &[u8], subject: &str) -> Result<Y4mHeader, VideoError> {
        let malformed = |problem: String| VideoError::malformed(subject, problem);
        let text = std::str::from_utf8(line).unwrap_or_default();
        let mut words = text.split_ascii_whitespace();
        if words.next() != Some("YUV4MPEG2") {
            return Err(malformed("not a YUV4MPEG2 video".into()));
        }
        let (mut width, mut height, mut rate, mut range) = (None, None, None, None);
        let mut chroma = "420";
        for word in words {
            let (Some(tag), value) = (word.chars().next(), word.get(1..).unwrap_or_default())
            else {
                continue;
            };
            let bad = || malformed(format!("the header says {word:?}"));
            match tag {
                'W' => width = Some(value.parse().map_err(|_| bad())?),
                'H' => height = Some(value.parse().map_err(|_| bad())?),
                'F' if value == "0:0" => {}
                'F' => {
                    let (frames, seconds) = value.split_once(':').ok_or_else(bad)?;
                    let pair = frames.parse().ok().zip(seconds.parse().ok());
                    rate = Some(pair.and_then(|(f, s)| Rate::new(f, s)).ok_or_else(bad)?);
                }
                'C' => chroma = value,
                'X' if value == "COLORRANGE=FULL" => range = Some(Range::Full),
                'X' if value == "COLORRANGE=LIMITED" => range = Some(Range::Limited),
                // Interlacing, pixel aspect and comments do not matter for reading.
                _ => {}
            }
        }
        let layout = match chroma {
            "420" | "420jpeg" | "420mpeg2" | "420paldv" => YuvLayout::Planar { across: 1, down: 1 },
            "422" => YuvLayout::Planar { across: 1, down: 0 },
            "444" => YuvLayout::Planar { across: 0, down: 0 },
            "411" => YuvLayout::Planar { across: 2, down: 0 },
            "mono" => YuvLayout::Grey,
            other => {
                let problem = format!(
                    "samples of type C{other} are not supported; C420, C422, C444, C411 and Cmono are"
                );
                return Err(VideoError::unsupported(subject, problem));
            }
        };
        let missing = |what| malformed(format!("the header gives no {what}"));
        Ok(Y4mHeader {
            width: width.ok_or_else(|| missing("width"))?,
            height: height.ok_or_else(|| missing("height"))?,
            rate,
            layout,
            range,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Y4mHeader, VideoError> {
        Y4mHeader::parse(text.as_bytes(), "film")
    }

    #[test]
    fn headers_of_the_field() {
        let planar = |across, down| YuvLayout::Planar { across, down };
        let plain =
            parse("YUV4MPEG2 W640 H480 F30000:1001 Ip A1:1 C420jpeg XYSCSS=420JPEG").unwrap();
        assert_eq!((plain.width, plain.height, plain.layout), (640, 480, planar(1, 1)));
        assert_eq!(plain.rate, Rate::new(30000, 1001));
        assert_eq!(plain.range, None);
        for (kind, layout) in [
            ("420mpeg2", planar(1, 1)),
            ("420paldv", planar(1, 1)),
            ("422", planar(1, 0)),
            ("444", planar(0, 0)),
            ("411", planar(2, 0)),
            ("mono", YuvLayout::Grey),
        ] {
            let text = format!("YUV4MPEG2 C{kind} H2 W3 F0:0 XCOLORRANGE=FULL");
            let header = parse(&text).unwrap();
            assert_eq!((header.layout, header.rate), (layout, None));
            assert_eq!(header.range, Some(Range::Full));
        }
        for bad in [
            "",
            "RIFF",
            "YUV4MPEG2",
            "YUV4MPEG2 W640",
            "YUV4MPEG2 H480",
            "YUV4MPEG2 W-1 H5",
            "YUV4MPEG2 W99999999999 H5",
            "YUV4MPEG2 W4 H4 F1",
            "YUV4MPEG2 W4 H4 F1:0",
            "YUV4MPEG2 W4 H4 C420p10",
            "YUV4MPEG2 W4 H4 C444alpha",
            "YUV4MPEG2 Wé H4",
        ] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}

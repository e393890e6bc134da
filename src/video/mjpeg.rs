//! Films of concatenated JPEG pictures in a file.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::time::Duration;

use super::address::FilmAddress;
use super::error::VideoError;
use super::frame::{MAX_COMPRESSED_BYTES, VideoFrame};
use super::jpeg::{self, Splitter};
use super::rate::Rate;
use super::reader::{Decoded, Fetched, Reader};

pub struct Mjpeg {
    file: BufReader<File>,
    subject: String,
    rate: Rate,
    splitter: Splitter,
    picture: Vec<u8>,
    /// Number of pictures fetched.
    index: u64,
}

impl Mjpeg {
    pub fn open(address: &FilmAddress) -> Result<Mjpeg, VideoError> {
        let (file, subject) = address.open_file()?;
        Ok(Mjpeg {
            file: BufReader::with_capacity(1 << 16, file),
            subject,
            rate: address.rate.unwrap_or(Rate::DEFAULT),
            splitter: Splitter::new(),
            picture: Vec::new(),
            index: 0,
        })
    }
}

impl Reader for Mjpeg {
    fn fetch(&mut self) -> Result<Fetched, VideoError> {
        loop {
            let bytes =
                self.file.fill_buf().map_err(|error| VideoError::io(&*self.subject, error))?;
            if bytes.is_empty() {
                // A truncated recording is shown up to its end.
                self.splitter.reset();
                if self.index == 0 {
                    let problem = "it contains no complete JPEG picture";
                    return Err(VideoError::malformed(&*self.subject, problem));
                }
                return Ok(Fetched::End);
            }
            let (used, whole) = self.splitter.feed(bytes);
            self.file.consume(used);
            if whole {
                self.splitter.swap_picture(&mut self.picture);
                let position = self.rate.time_of(self.index);
                self.index += 1;
                let broken = self.splitter.take_broken();
                return Ok(Fetched::Picture { position, stale: 0, broken });
            }
            if self.splitter.outside() > MAX_COMPRESSED_BYTES {
                return Err(VideoError::malformed(&*self.subject, "it contains no JPEG pictures"));
            }
        }
    }

    fn decode(&mut self, frame: &mut VideoFrame) -> Result<Decoded, VideoError> {
        Ok(jpeg::decode(&self.picture, &self.subject, frame))
    }

    fn rewind(&mut self) -> Result<Duration, VideoError> {
        self.file.rewind().map_err(|error| VideoError::io(&*self.subject, error))?;
        self.splitter.reset();
        let length = self.rate.time_of(self.index);
        self.index = 0;
        Ok(length)
    }
}

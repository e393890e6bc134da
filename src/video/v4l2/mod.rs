//! Cameras of a Linux computer.
//!
//! Uses `linuxvideo`, which needs no C library. Multi-planar cameras (of embedded boards) are not supported. The bytes
//! of a picture are copied from the driver's buffer at once, which frees it for the next one.

mod modes;

use std::io::{Error, ErrorKind};
use std::time::{Duration, Instant};

use linuxvideo::format::{PixFormat, PixelFormat};
use linuxvideo::stream::ReadStream;
use linuxvideo::{BufTypes, Device, Fract};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use self::modes::{DEFAULT_SIZE, FrameEncoding, choose, coding_of, modes_of, offered};
use super::address::CameraAddress;
use super::colour::{Colour, Range};
use super::error::VideoError;
use super::frame::{VideoFrame, check_size};
use super::jpeg::{self, Splitter};
use super::rate::Rate;
use super::reader::{Decoded, FETCH_WAIT, Fetched, Reader};
use super::yuv::{LineBuffers, YuvLayout, YuvPicture, to_rgba};

pub use self::modes::{CameraInfo, CameraMode, cameras};

/// An opened camera.
pub struct V4l2Camera {
    stream: ReadStream,
    subject: String,
    coding: FrameEncoding,
    width: u32,
    height: u32,
    stride: usize,
    colour: Colour,
    opened: Instant,
    bytes: Vec<u8>,
    /// The driver reported that the bytes are damaged.
    damaged: bool,
    splitter: Splitter,
    picture: Vec<u8>,
    lines: LineBuffers,
}

impl V4l2Camera {
    pub fn open(address: &CameraAddress) -> Result<V4l2Camera, VideoError> {
        let subject = address.device.display().to_string();
        let io = |error: Error| VideoError::io(&*subject, error);
        let device = Device::open(&address.device).map_err(io)?;
        if !device.supported_buf_types().contains(BufTypes::VIDEO_CAPTURE) {
            let problem = "not a camera, or one with an unsupported multi-planar interface";
            return Err(VideoError::unsupported(subject, problem));
        }
        let size = address.size.unwrap_or(DEFAULT_SIZE);
        let rate = address.rate.unwrap_or(Rate::DEFAULT);
        let modes = modes_of(&device, size);
        let Some(mode) = choose(&modes, address.format, size, rate) else {
            let what = address.format.map(|code| PixelFormat::from_fourcc(code).to_string());
            let what = what.as_deref().unwrap_or("format that is read here");
            let problem = format!("it offers no {what}, but {}", offered(&device));
            return Err(VideoError::unsupported(subject, problem));
        };
        let format = PixelFormat::from_fourcc(mode.format);
        let capture =
            device.video_capture(PixFormat::new(mode.width, mode.height, format)).map_err(io)?;
        let (frames, seconds) = rate.fraction();
        if let Err(error) = capture.set_frame_interval(Fract::new(seconds, frames)) {
            tracing::debug!("{subject}: it keeps its own frame rate ({error})");
        }
        let got = capture.format();
        let (width, height) = (got.width(), got.height());
        check_size(u64::from(width), u64::from(height), &subject)?;
        let Some(coding) = coding_of(got.pixel_format()) else {
            let problem = format!("it insists on the format {}", got.pixel_format());
            return Err(VideoError::unsupported(subject, problem));
        };
        let stride = match coding {
            FrameEncoding::Raw(layout) => {
                (got.bytes_per_line() as usize).max(layout.least_stride(width as usize))
            }
            FrameEncoding::Jpeg => 0,
        };
        let name = got.pixel_format();
        tracing::info!("{subject}: {width} x {height} {name}, {} a second", mode.per_second);
        let stream = capture.into_stream().map_err(io)?;
        Ok(V4l2Camera {
            stream,
            subject,
            coding,
            width,
            height,
            stride,
            colour: address.colour.over(said_colour(coding)),
            opened: Instant::now(),
            bytes: Vec::new(),
            damaged: false,
            splitter: Splitter::new(),
            picture: Vec::new(),
            lines: LineBuffers::default(),
        })
    }

    fn dequeue(&mut self) -> Result<(), VideoError> {
        let (bytes, damaged) = (&mut self.bytes, &mut self.damaged);
        self.stream
            .dequeue(|view| {
                bytes.clear();
                bytes.extend_from_slice(&view);
                *damaged = view.is_error();
                Ok(())
            })
            .map_err(|error| VideoError::io(&*self.subject, error))
    }
}

/// Returns the default colours of a camera: those of grey cameras come straight from the sensor, in full range.
fn said_colour(coding: FrameEncoding) -> Colour {
    match coding {
        FrameEncoding::Raw(YuvLayout::Grey) => Colour { range: Range::Full, ..Colour::DEFAULT },
        FrameEncoding::Raw(_) | FrameEncoding::Jpeg => Colour::DEFAULT,
    }
}

impl Reader for V4l2Camera {
    fn fetch(&mut self) -> Result<Fetched, VideoError> {
        let mut events = [PollFd::new(&self.stream, PollFlags::IN)];
        let wait = Timespec { tv_sec: 0, tv_nsec: FETCH_WAIT.subsec_nanos().into() };
        match poll(&mut events, Some(&wait)) {
            Ok(0) | Err(rustix::io::Errno::INTR) => return Ok(Fetched::Idle),
            Ok(_) => {}
            Err(error) => return Err(VideoError::io(&*self.subject, error)),
        }
        if !events[0].revents().contains(PollFlags::IN) {
            let error = Error::new(ErrorKind::NotConnected, "the camera has been disconnected");
            return Err(VideoError::io(&*self.subject, error));
        }
        self.dequeue()?;
        let mut stale = 0;
        // Up to one per buffer may be waiting; take the newest.
        while stale < 8
            && !self.stream.will_block().map_err(|e| VideoError::io(&*self.subject, e))?
        {
            self.dequeue()?;
            stale += 1;
        }
        Ok(Fetched::Picture { position: self.opened.elapsed(), stale, broken: 0 })
    }

    fn decode(&mut self, frame: &mut VideoFrame) -> Result<Decoded, VideoError> {
        let broken =
            |problem: String| Ok(Decoded::Broken(VideoError::malformed(&*self.subject, problem)));
        if self.damaged {
            return broken("the driver reports a damaged picture".into());
        }
        match self.coding {
            FrameEncoding::Raw(layout) => {
                frame.shape(self.width, self.height, &self.subject)?;
                let (width, height) = (self.width as usize, self.height as usize);
                let planes =
                    YuvPicture { layout, width, height, stride: self.stride, data: &self.bytes };
                match to_rgba(planes, self.colour, &mut self.lines, &mut frame.pixels) {
                    Ok(()) => Ok(Decoded::Whole),
                    Err(problem) => broken(problem),
                }
            }
            FrameEncoding::Jpeg => {
                self.splitter.reset();
                let (_, whole) = self.splitter.feed(&self.bytes);
                if !whole {
                    return broken("a truncated JPEG".into());
                }
                self.splitter.swap_picture(&mut self.picture);
                Ok(jpeg::decode(&self.picture, &self.subject, frame))
            }
        }
    }

    fn rewind(&mut self) -> Result<Duration, VideoError> {
        Err(VideoError::unsupported(&*self.subject, "a camera cannot be rewound"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_that_is_no_camera_is_reported() {
        let address = |device: &str| match format!("v4l2:{device}").parse() {
            Ok(super::super::Address::Camera(camera)) => camera,
            other => panic!("{other:?}"),
        };
        for device in ["/dev/null", "/nonexistent", "/dev"] {
            let error = V4l2Camera::open(&address(device)).err().unwrap();
            assert!(error.to_string().starts_with(device), "{error}");
        }
        assert!(cameras().is_ok());
    }
}

//! Owns the cameras of a Linux computer: what there are, and pictures from one of them.
//!
//! Reads by `linuxvideo`, which speaks to the kernel without any C library. Cameras with several
//! planes of memory (embedded boards) are not read. A picture's bytes are copied out of the
//! driver's buffer at once, which then is free for the next one.

use std::fs;
use std::io::{Error, ErrorKind};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use linuxvideo::format::{FrameIntervals, FrameSizes, PixFormat, PixelFormat};
use linuxvideo::stream::ReadStream;
use linuxvideo::{BufType, BufTypes, Device, Fract};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::address::CameraAddress;
use super::error::{VideoError, guarded};
use super::frame::{Frame, check_size};
use super::jpeg::{self, Splitter};
use super::rate::Rate;
use super::reader::{Decoded, FETCH_WAIT, Fetched, Reader};
use super::yuv::{Colour, Layout, Lines, Planes, to_rgba};

/// What is asked of a camera where the address says nothing.
const DEFAULT_SIZE: (u32, u32) = (1280, 720);

/// What the bytes of a picture are.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Coding {
    Raw(Layout),
    Jpeg,
}

/// The formats read, the better ones first: fewer bytes, then less to decode.
const FORMATS: [([u8; 4], Coding); 7] = [
    (*b"NV12", Coding::Raw(Layout::Nv12)),
    (*b"YU12", Coding::Raw(Layout::Planar { across: 1, down: 1 })),
    (*b"YUYV", Coding::Raw(Layout::Yuyv)),
    (*b"UYVY", Coding::Raw(Layout::Uyvy)),
    (*b"MJPG", Coding::Jpeg),
    (*b"JPEG", Coding::Jpeg),
    (*b"GREY", Coding::Raw(Layout::Grey)),
];

/// A camera that is there.
#[derive(Debug)]
pub struct CameraInfo {
    pub device: PathBuf,
    pub name: String,
    /// What it offers in formats that are read here, or why it does not say.
    pub modes: Result<Vec<CameraMode>, VideoError>,
}

/// A format, a size, and the most pictures a second at that.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CameraMode {
    pub format: [u8; 4],
    pub width: u32,
    pub height: u32,
    /// 0 where the driver does not say.
    pub per_second: f64,
}

/// The cameras of this computer, in the order of their devices.
///
/// # Errors
/// Where the devices cannot be listed at all.
pub fn cameras() -> Result<Vec<CameraInfo>, VideoError> {
    let entries = fs::read_dir("/dev").map_err(|error| VideoError::io("/dev", error))?;
    let mut numbers: Vec<u32> = entries
        .filter_map(|entry| entry.ok()?.file_name().to_str()?.strip_prefix("video")?.parse().ok())
        .collect();
    numbers.sort_unstable();
    let mut found = Vec::new();
    for number in numbers {
        let device = PathBuf::from(format!("/dev/video{number}"));
        let name = fs::read(format!("/sys/class/video4linux/video{number}/name"));
        let name = String::from_utf8_lossy(&name.unwrap_or_default()).trim().to_owned();
        let subject = device.display().to_string();
        let modes = guarded(&subject, || {
            let opened = Device::open(&device).map_err(|e| VideoError::io(&*subject, e))?;
            let captures = opened.supported_buf_types().contains(BufTypes::VIDEO_CAPTURE);
            Ok(captures.then(|| modes_of(&opened, DEFAULT_SIZE)))
        });
        // Encoders, outputs and the like are no cameras.
        if let Some(modes) = modes.transpose() {
            found.push(CameraInfo { device, name, modes });
        }
    }
    Ok(found)
}

/// The modes in known formats; of cameras that scale to any size, the one nearest to `wanted`.
fn modes_of(device: &Device, wanted: (u32, u32)) -> Vec<CameraMode> {
    let mut modes = Vec::new();
    for offered in device.formats(BufType::VIDEO_CAPTURE).map_while(Result::ok).take(64) {
        let format = offered.pixel_format();
        if !FORMATS.iter().any(|(code, _)| *code == format.as_fourcc()) {
            continue;
        }
        let sizes: Vec<(u32, u32)> = match device.frame_sizes(format) {
            Ok(FrameSizes::Discrete(sizes)) => {
                sizes.iter().take(256).map(|size| (size.width(), size.height())).collect()
            }
            Ok(FrameSizes::Stepwise(range) | FrameSizes::Continuous(range)) => {
                let step = |wanted: u32, least: u32, most: u32, step: u32| {
                    let inside = wanted.clamp(least, most.max(least));
                    inside - (inside - least) % step.max(1)
                };
                let (w, h) = wanted;
                vec![(
                    step(w, range.min_width(), range.max_width(), range.step_width()),
                    step(h, range.min_height(), range.max_height(), range.step_height()),
                )]
            }
            // Old drivers do not list sizes; they take what comes near when asked.
            Err(_) => vec![wanted],
        };
        modes.extend(sizes.into_iter().map(|(width, height)| {
            let per_second = most_per_second(device, format, width, height);
            CameraMode { format: format.as_fourcc(), width, height, per_second }
        }));
    }
    modes
}

fn most_per_second(device: &Device, format: PixelFormat, width: u32, height: u32) -> f64 {
    let rate = |interval: &Fract| match interval.numerator() {
        0 => 0.0,
        seconds => f64::from(interval.denominator()) / f64::from(seconds),
    };
    match device.frame_intervals(format, width, height) {
        Ok(FrameIntervals::Discrete(list)) => {
            list.iter().map(|interval| rate(interval.fract())).fold(0.0, f64::max)
        }
        Ok(FrameIntervals::Stepwise(range) | FrameIntervals::Continuous(range)) => {
            rate(range.min())
        }
        Err(_) => 0.0,
    }
}

/// The mode nearest in size; of those the quickest up to the rate wanted; of those the best format.
fn choose(
    modes: &[CameraMode],
    format: Option<[u8; 4]>,
    size: (u32, u32),
    rate: Rate,
) -> Option<CameraMode> {
    let key = |mode: &CameraMode| {
        let distance = mode.width.abs_diff(size.0).saturating_add(mode.height.abs_diff(size.1));
        // Tenths, so that 29.97 is as good as 30.
        let missing = ((rate.per_second() - mode.per_second).max(0.0) * 10.0).round() as u64;
        let preference = FORMATS.iter().position(|(code, _)| *code == mode.format);
        (distance, missing, preference)
    };
    let wanted = modes.iter().filter(|mode| format.is_none_or(|format| mode.format == format));
    wanted.min_by_key(|mode| key(mode)).copied()
}

/// An opened camera.
pub struct Camera {
    stream: ReadStream,
    subject: String,
    coding: Coding,
    width: u32,
    height: u32,
    stride: usize,
    colour: Colour,
    opened: Instant,
    bytes: Vec<u8>,
    /// The driver says that the bytes are damaged.
    damaged: bool,
    splitter: Splitter,
    picture: Vec<u8>,
    lines: Lines,
}

impl Camera {
    pub fn open(address: &CameraAddress) -> Result<Camera, VideoError> {
        let subject = address.device.display().to_string();
        let io = |error: Error| VideoError::io(&*subject, error);
        let device = Device::open(&address.device).map_err(io)?;
        if !device.supported_buf_types().contains(BufTypes::VIDEO_CAPTURE) {
            let problem = "not a camera, or one with several planes of memory";
            return Err(VideoError::unsupported(subject, problem));
        }
        let size = address.size.unwrap_or(DEFAULT_SIZE);
        let rate = address.rate.unwrap_or(Rate::DEFAULT);
        let modes = modes_of(&device, size);
        let Some(mode) = choose(&modes, address.format, size, rate) else {
            let problem = format!("it offers only {}", offered(&device));
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
        let code = got.pixel_format().as_fourcc();
        let Some(&(_, coding)) = FORMATS.iter().find(|(known, _)| *known == code) else {
            let problem = format!("it insists on the format {}", got.pixel_format());
            return Err(VideoError::unsupported(subject, problem));
        };
        let stride = match coding {
            Coding::Raw(layout) => {
                (got.bytes_per_line() as usize).max(layout.least_stride(width as usize))
            }
            Coding::Jpeg => 0,
        };
        let name = got.pixel_format();
        tracing::info!("{subject}: {width} x {height} {name}, {} a second", mode.per_second);
        let stream = capture.into_stream().map_err(io)?;
        Ok(Camera {
            stream,
            subject,
            coding,
            width,
            height,
            stride,
            colour: address.colour.over(Colour::DEFAULT),
            opened: Instant::now(),
            bytes: Vec::new(),
            damaged: false,
            splitter: Splitter::new(),
            picture: Vec::new(),
            lines: Lines::default(),
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

/// What a camera offers, for people.
fn offered(device: &Device) -> String {
    let formats = device.formats(BufType::VIDEO_CAPTURE).map_while(Result::ok).take(64);
    let names: Vec<String> = formats.map(|format| format.pixel_format().to_string()).collect();
    if names.is_empty() { "no format at all".into() } else { names.join(", ") }
}

impl Reader for Camera {
    fn fetch(&mut self) -> Result<Fetched, VideoError> {
        let mut events = [PollFd::new(&self.stream, PollFlags::IN)];
        let wait = Timespec { tv_sec: 0, tv_nsec: FETCH_WAIT.subsec_nanos().into() };
        match poll(&mut events, Some(&wait)) {
            Ok(0) | Err(rustix::io::Errno::INTR) => return Ok(Fetched::Idle),
            Ok(_) => {}
            Err(error) => return Err(VideoError::io(&*self.subject, error)),
        }
        if !events[0].revents().contains(PollFlags::IN) {
            let error = Error::new(ErrorKind::NotConnected, "the camera is gone");
            return Err(VideoError::io(&*self.subject, error));
        }
        self.dequeue()?;
        let mut stale = 0;
        // As many as there are buffers may wait; the newest is wanted.
        while stale < 8
            && !self.stream.will_block().map_err(|e| VideoError::io(&*self.subject, e))?
        {
            self.dequeue()?;
            stale += 1;
        }
        Ok(Fetched::Picture { position: self.opened.elapsed(), stale, broken: 0 })
    }

    fn decode(&mut self, frame: &mut Frame) -> Result<Decoded, VideoError> {
        let broken =
            |problem: String| Ok(Decoded::Broken(VideoError::malformed(&*self.subject, problem)));
        if self.damaged {
            return broken("the driver reports a damaged picture".into());
        }
        match self.coding {
            Coding::Raw(layout) => {
                frame.shape(self.width, self.height, &self.subject)?;
                let (width, height) = (self.width as usize, self.height as usize);
                let planes =
                    Planes { layout, width, height, stride: self.stride, data: &self.bytes };
                match to_rgba(planes, self.colour, &mut self.lines, &mut frame.pixels) {
                    Ok(()) => Ok(Decoded::Whole),
                    Err(problem) => broken(problem),
                }
            }
            Coding::Jpeg => {
                self.splitter.reset();
                let (_, whole) = self.splitter.feed(&self.bytes);
                if !whole {
                    return broken("a JPEG that breaks off".into());
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

    fn mode(format: &[u8; 4], width: u32, height: u32, per_second: f64) -> CameraMode {
        CameraMode { format: *format, width, height, per_second }
    }

    #[test]
    fn a_webcam_gives_its_best() {
        // As USB 2 cameras offer: big pictures quickly only as JPEG.
        let modes = [
            mode(b"YUYV", 640, 480, 30.0),
            mode(b"YUYV", 1280, 720, 10.0),
            mode(b"MJPG", 640, 480, 30.0),
            mode(b"MJPG", 1280, 720, 29.97),
            mode(b"MJPG", 1920, 1080, 30.0),
        ];
        let pick = |format, size, rate: &str| choose(&modes, format, size, rate.parse().unwrap());
        assert_eq!(pick(None, (1280, 720), "30"), Some(modes[3]));
        assert_eq!(pick(None, (1280, 720), "10"), Some(modes[1]));
        assert_eq!(pick(None, (640, 480), "30"), Some(modes[0]));
        assert_eq!(pick(None, (4000, 3000), "60"), Some(modes[4]));
        assert_eq!(pick(Some(*b"YUYV"), (1280, 720), "30"), Some(modes[1]));
        assert_eq!(pick(Some(*b"NV12"), (1280, 720), "30"), None);
        assert_eq!(choose(&[], None, (1, 1), Rate::DEFAULT), None);
    }

    #[test]
    fn what_is_no_camera_says_so() {
        let address = |device: &str| match format!("v4l2:{device}").parse() {
            Ok(super::super::Address::Camera(camera)) => camera,
            other => panic!("{other:?}"),
        };
        for device in ["/dev/null", "/nonexistent", "/dev"] {
            let error = Camera::open(&address(device)).err().unwrap();
            assert!(error.to_string().starts_with(device), "{error}");
        }
        assert!(cameras().is_ok());
    }
}

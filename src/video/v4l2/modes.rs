//! The cameras of a Linux computer, their modes, and the choice of one.

use std::fs;
use std::path::PathBuf;

use linuxvideo::format::{FrameIntervals, FrameSizes, PixelFormat};
use linuxvideo::{BufType, BufTypes, Device, Fract};

use crate::video::error::{VideoError, guarded};
use crate::video::rate::Rate;
use crate::video::yuv::YuvLayout;

/// The requested size if the address has no options.
pub(super) const DEFAULT_SIZE: (u32, u32) = (1280, 720);

/// The encoding of a picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum FrameEncoding {
    Raw(YuvLayout),
    Jpeg,
}

/// The supported formats, best first: fewer bytes, then less to decode.
const FORMATS: [([u8; 4], FrameEncoding); 7] = [
    (*b"NV12", FrameEncoding::Raw(YuvLayout::Nv12)),
    (*b"YU12", FrameEncoding::Raw(YuvLayout::Planar { across: 1, down: 1 })),
    (*b"YUYV", FrameEncoding::Raw(YuvLayout::Yuyv)),
    (*b"UYVY", FrameEncoding::Raw(YuvLayout::Uyvy)),
    (*b"MJPG", FrameEncoding::Jpeg),
    (*b"JPEG", FrameEncoding::Jpeg),
    (*b"GREY", FrameEncoding::Raw(YuvLayout::Grey)),
];

/// Returns the encoding of a format; `None` if it is not supported.
pub(super) fn coding_of(format: PixelFormat) -> Option<FrameEncoding> {
    FORMATS.iter().find(|(code, _)| *code == format.as_fourcc()).map(|(_, coding)| *coding)
}

/// A connected camera.
#[derive(Debug)]
pub struct CameraInfo {
    pub device: PathBuf,
    pub name: String,
    /// Its modes in supported formats, or the error of listing them.
    pub modes: Result<Vec<CameraMode>, VideoError>,
}

/// A format, a size, and the highest frame rate at that size.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct CameraMode {
    pub format: [u8; 4],
    pub width: u32,
    pub height: u32,
    /// 0 if the driver does not report it.
    pub per_second: f64,
}

/// The cameras of this computer, in the order of their devices.
///
/// # Errors
/// If the devices cannot be listed at all.
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
        // Encoders, outputs and the like are not cameras.
        if let Some(modes) = modes.transpose() {
            found.push(CameraInfo { device, name, modes });
        }
    }
    Ok(found)
}

/// Returns the modes in supported formats; of cameras that scale to any size, the one nearest to `wanted`.
pub(super) fn modes_of(device: &Device, wanted: (u32, u32)) -> Vec<CameraMode> {
    let mut modes = Vec::new();
    for offered in device.formats(BufType::VIDEO_CAPTURE).map_while(Result::ok).take(64) {
        let format = offered.pixel_format();
        if coding_of(format).is_none() {
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
            // Old drivers do not list sizes; they choose something close to the request.
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

/// Returns the mode nearest in size; among those the fastest up to the wanted rate; among those the best format.
pub(super) fn choose(
    modes: &[CameraMode],
    format: Option<[u8; 4]>,
    size: (u32, u32),
    rate: Rate,
) -> Option<CameraMode> {
    let key = |mode: &CameraMode| {
        let distance = mode.width.abs_diff(size.0).saturating_add(mode.height.abs_diff(size.1));
        // In tenths, so that 29.97 equals 30.
        let missing = ((rate.per_second() - mode.per_second).max(0.0) * 10.0).round() as u64;
        let preference = FORMATS.iter().position(|(code, _)| *code == mode.format);
        (distance, missing, preference)
    };
    let wanted = modes.iter().filter(|mode| format.is_none_or(|format| mode.format == format));
    wanted.min_by_key(|mode| key(mode)).copied()
}

/// Returns the modes of a camera, for messages: the beginning of its list.
pub(super) fn offered(device: &Device) -> String {
    let formats = device.formats(BufType::VIDEO_CAPTURE).map_while(Result::ok).take(16);
    let names: Vec<String> = formats.map(|format| format.pixel_format().to_string()).collect();
    if names.is_empty() { "no other either".into() } else { names.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(format: &[u8; 4], width: u32, height: u32, per_second: f64) -> CameraMode {
        CameraMode { format: *format, width, height, per_second }
    }

    #[test]
    fn a_webcam_gives_its_best() {
        // Like USB 2 cameras: large pictures at full rate only as JPEG.
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
}

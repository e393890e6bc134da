//! Addresses of video sources, as users write them.
//!
//! | text | source |
//! |---|---|
//! | `v4l2:/dev/video0?size=1280x720&fps=30&format=yuyv` | a camera of this computer (Linux) |
//! | `film.y4m?loop=no&fps=25&matrix=bt709&range=full` | an uncompressed film |
//! | `film.mjpeg`, `film.mjpg` | a film of JPEG pictures |
//! | `folder/` | a folder of PNG pictures of one size |
//! | `http://host:port/path` | a phone or network camera that sends MJPEG |
//!
//! Options follow the last `?` and may be left out. Films repeat unless `loop=no`.

use std::fs::File;
use std::path::PathBuf;
use std::str::FromStr;

use super::colour::{ColourChoice, Matrix, Range};
use super::error::VideoError;
use super::frame::check_size;
use super::http::Url;
use super::rate::Rate;

/// The source of a video.
#[derive(Clone, PartialEq, Debug)]
pub enum Address {
    Camera(CameraAddress),
    Film(FilmAddress),
    Http(Url),
}

/// A camera of this computer with the requested mode; it may use a similar one.
#[derive(Clone, PartialEq, Debug)]
pub struct CameraAddress {
    pub device: PathBuf,
    /// Pixels.
    pub size: Option<(u32, u32)>,
    pub rate: Option<Rate>,
    /// A V4L2 fourcc, such as `YUYV`, `NV12` or `MJPG`.
    pub format: Option<[u8; 4]>,
    pub colour: ColourChoice,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FilmKind {
    Y4m,
    Mjpeg,
    PngFolder,
}

/// A file or folder.
#[derive(Clone, PartialEq, Debug)]
pub struct FilmAddress {
    pub path: PathBuf,
    pub kind: FilmKind,
    /// Repeat at the end.
    pub repeat: bool,
    /// Overrides the rate of the film.
    pub rate: Option<Rate>,
    pub colour: ColourChoice,
}

impl FilmAddress {
    /// Returns the opened file, and its name for messages.
    pub(super) fn open_file(&self) -> Result<(File, String), VideoError> {
        let subject = self.path.display().to_string();
        // Checked before opening, since opening a pipe waits for its other end.
        let known = std::fs::metadata(&self.path).map_err(|e| VideoError::io(&*subject, e))?;
        if !known.is_file() {
            return Err(VideoError::unsupported(subject, "not a regular file"));
        }
        let file = File::open(&self.path).map_err(|e| VideoError::io(&*subject, e))?;
        Ok((file, subject))
    }
}

impl FromStr for Address {
    type Err = VideoError;

    fn from_str(text: &str) -> Result<Address, VideoError> {
        parse(text.trim()).map_err(|problem| VideoError::Address { text: text.into(), problem })
    }
}

fn parse(text: &str) -> Result<Address, String> {
    if text.is_empty() {
        return Err("it is empty".into());
    }
    if let Some(rest) = strip_scheme(text, "http://") {
        return Url::parse(rest).map(Address::Http);
    }
    for scheme in ["https://", "rtsp://", "rtmp://", "ftp://"] {
        if strip_scheme(text, scheme).is_some() {
            return Err(format!("{scheme} is not supported; http:// with MJPEG is"));
        }
    }
    let (place, options) = match text.rsplit_once('?') {
        // A question mark without options after it belongs to the name.
        Some((place, options)) if options.contains('=') => (place, options),
        _ => (text, ""),
    };
    let mut options = Options::parse(options)?;
    let address = if let Some(device) = strip_scheme(place, "v4l2:") {
        if device.is_empty() {
            return Err("it names no device; write it like v4l2:/dev/video0".into());
        }
        Address::Camera(CameraAddress {
            device: device.into(),
            size: options.take("size", size)?,
            rate: options.take("fps", Rate::from_str)?,
            format: options.take("format", format)?,
            colour: options.colour()?,
        })
    } else {
        let path = PathBuf::from(place);
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        let kind = match extension.to_str() {
            Some("y4m") => FilmKind::Y4m,
            Some("mjpeg" | "mjpg") => FilmKind::Mjpeg,
            Some("avi" | "mp4" | "mkv" | "mov" | "webm" | "png" | "jpg" | "jpeg" | "gif") => {
                return Err("this type of file is not supported; use .y4m, .mjpeg, .mjpg or a folder of .png files".into());
            }
            _ => FilmKind::PngFolder,
        };
        let colour =
            if kind == FilmKind::Y4m { options.colour()? } else { ColourChoice::default() };
        Address::Film(FilmAddress {
            path,
            kind,
            repeat: options.take("loop", yes_or_no)?.unwrap_or(true),
            rate: options.take("fps", Rate::from_str)?,
            colour,
        })
    };
    options.finish()?;
    Ok(address)
}

fn strip_scheme<'a>(text: &'a str, scheme: &str) -> Option<&'a str> {
    let (start, rest) = text.split_at_checked(scheme.len())?;
    start.eq_ignore_ascii_case(scheme).then_some(rest)
}

/// The `key=value` pairs not yet used.
struct Options<'a>(Vec<(&'a str, &'a str)>);

impl<'a> Options<'a> {
    fn parse(text: &'a str) -> Result<Options<'a>, String> {
        let mut pairs: Vec<(&str, &str)> = Vec::new();
        for option in text.split('&').filter(|option| !option.is_empty()) {
            let Some((key, value)) = option.split_once('=') else {
                return Err(format!("the option {option:?} has no value"));
            };
            if pairs.iter().any(|(k, _)| *k == key) {
                return Err(format!("the option {key:?} is given twice"));
            }
            pairs.push((key, value));
        }
        Ok(Options(pairs))
    }

    fn take<T>(
        &mut self,
        key: &str,
        parse: impl Fn(&str) -> Result<T, String>,
    ) -> Result<Option<T>, String> {
        let Some(at) = self.0.iter().position(|(k, _)| *k == key) else {
            return Ok(None);
        };
        let (_, value) = self.0.swap_remove(at);
        parse(value).map(Some).map_err(|problem| format!("{key}: {problem}"))
    }

    fn colour(&mut self) -> Result<ColourChoice, String> {
        let matrix = self.take("matrix", |text| match text {
            "bt601" => Ok(Matrix::Bt601),
            "bt709" => Ok(Matrix::Bt709),
            _ => Err(format!("{text:?} is neither bt601 nor bt709")),
        })?;
        let range = self.take("range", |text| match text {
            "limited" => Ok(Range::Limited),
            "full" => Ok(Range::Full),
            _ => Err(format!("{text:?} is neither limited nor full")),
        })?;
        Ok(ColourChoice { matrix, range })
    }

    fn finish(self) -> Result<(), String> {
        match self.0.first() {
            Some((key, _)) => Err(format!("{key:?} is not an option of this kind of source")),
            None => Ok(()),
        }
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let pair = text.split_once('x').and_then(|(w, h)| w.parse().ok().zip(h.parse().ok()));
    let (width, height) =
        pair.ok_or_else(|| format!("{text:?} is not a size; write it like 1280x720"))?;
    check_size(u64::from(width), u64::from(height), text).map_err(|error| error.to_string())?;
    Ok((width, height))
}

fn yes_or_no(text: &str) -> Result<bool, String> {
    match text {
        "yes" | "true" => Ok(true),
        "no" | "false" => Ok(false),
        _ => Err(format!("{text:?} is neither yes nor no")),
    }
}

/// Returns the common names, or any V4L2 fourcc.
fn format(text: &str) -> Result<[u8; 4], String> {
    let upper = text.to_ascii_uppercase();
    let code = match upper.as_str() {
        "MJPEG" => "MJPG",
        "I420" => "YU12",
        other => other,
    };
    <[u8; 4]>::try_from(code.as_bytes())
        .ok()
        .filter(|code| code.is_ascii())
        .ok_or_else(|| format!("{text:?} is not a format; write four characters, such as YUYV"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn camera(text: &str) -> CameraAddress {
        match text.parse() {
            Ok(Address::Camera(camera)) => camera,
            other => panic!("{text}: {other:?}"),
        }
    }

    fn film(text: &str) -> FilmAddress {
        match text.parse() {
            Ok(Address::Film(film)) => film,
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn addresses_of_each_kind() {
        let full = camera("v4l2:/dev/video0?size=1280x720&fps=30&format=mjpeg&range=full");
        assert_eq!(full.device, PathBuf::from("/dev/video0"));
        assert_eq!((full.size, full.rate), (Some((1280, 720)), Rate::new(30000, 1000)));
        assert_eq!(full.format, Some(*b"MJPG"));
        assert_eq!(full.colour, ColourChoice { matrix: None, range: Some(Range::Full) });
        assert_eq!(camera("V4L2:/dev/video1").size, None);
        assert_eq!(camera("v4l2:x?format=i420").format, Some(*b"YU12"));

        let y4m = film("a b/Film.Y4M?loop=no&fps=30000/1001&matrix=bt709");
        assert_eq!((y4m.kind, y4m.repeat), (FilmKind::Y4m, false));
        assert_eq!(y4m.path, PathBuf::from("a b/Film.Y4M"));
        assert_eq!((y4m.rate, y4m.colour.matrix), (Rate::new(30000, 1001), Some(Matrix::Bt709)));
        assert_eq!(film("x.mjpg").kind, FilmKind::Mjpeg);
        assert!(film("x.mjpeg").repeat);
        assert_eq!(film("what?/frames").path, PathBuf::from("what?/frames"));
        assert_eq!(film("frames/").kind, FilmKind::PngFolder);
        assert!(matches!("http://10.0.0.2:8080/video?x=1".parse(), Ok(Address::Http(_))));
    }

    #[test]
    fn wrong_addresses_say_why() {
        for (text, why) in [
            ("", "empty"),
            ("v4l2:", "no device"),
            ("v4l2:/dev/video0?size=0x5", "0 x 5"),
            ("v4l2:/dev/video0?size=99999x99999", "pixels"),
            ("v4l2:/dev/video0?size=big", "not a size"),
            ("v4l2:/dev/video0?fps=0", "frame rate"),
            ("v4l2:/dev/video0?format=rainbow", "four characters"),
            ("v4l2:/dev/video0?loop=no", "not an option"),
            ("x.y4m?fps=3&fps=4", "twice"),
            ("x.y4m?fps=3&loop", "no value"),
            ("x.y4m?loop=maybe", "neither"),
            ("x.mjpeg?range=full", "not an option"),
            ("x.mp4", ".y4m"),
            ("https://a/b", "not supported"),
        ] {
            let error = text.parse::<Address>().unwrap_err().to_string();
            assert!(error.contains(why), "{text}: {error}");
        }
    }

    proptest! {
        #[test]
        fn no_text_makes_it_panic(text in "(v4l2:|http://|HTTPS://|)?[\\PC?&=x:/@\\[\\].]{0,40}") {
            let _ = text.parse::<Address>();
        }
    }
}

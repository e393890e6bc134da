//! The files of a film: a folder of pictures, an animated PNG or GIF, or raw video.
//!
//! Takes pictures one by one, and writes each before it requests the next. A file gets its name when it is complete: a
//! failed or cancelled film leaves whole pictures in its folder, or no file.

use std::fs;
use std::io::{BufWriter, Error, Write};
use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType, Encoder, EncodingError};

use super::frames::{BUFFER_BYTES, Format, NextPicture, cannot_write, finish};
use super::{FilmError, gif, y4m};
use crate::format::store::{self, AtomicFile};
use crate::picture;

/// The form of a film's output.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Form {
    /// A PNG for each frame.
    Folder,
    AnimatedPng,
    Gif,
    Y4m,
}

/// A film to be written.
pub struct Output {
    target: FilmTarget,
    path: PathBuf,
    format: Format,
}

enum FilmTarget {
    Folder,
    AnimatedPng(AtomicFile),
    Gif(AtomicFile),
    Y4m(AtomicFile),
}

impl Form {
    /// Returns the form for a name. A name without an extension, with a slash at its end, or of an existing folder
    /// means a folder.
    pub fn of(path: &Path) -> Result<Form, String> {
        let ends_with_slash = path.to_string_lossy().ends_with(std::path::is_separator);
        let ending = path.extension().filter(|_| !ends_with_slash && !path.is_dir());
        match ending.map(|ending| ending.to_string_lossy().to_ascii_lowercase()).as_deref() {
            None => Ok(Form::Folder),
            Some("png" | "apng") => Ok(Form::AnimatedPng),
            Some("gif") => Ok(Form::Gif),
            Some("y4m") => Ok(Form::Y4m),
            Some(_) => {
                Err("the name must end in .png or .apng (animated), .gif or .y4m, or be that of \
                            a folder for pictures: without an ending, or with a slash"
                    .to_string())
            }
        }
    }

    /// Returns the files of a film.
    pub fn paths(self, path: &Path, format: &Format) -> Vec<PathBuf> {
        match self {
            Form::Folder => format.part.clone().map(|f| format.frame_path(path, f)).collect(),
            Form::AnimatedPng | Form::Gif | Form::Y4m => vec![path.to_path_buf()],
        }
    }
}

impl Output {
    /// Begins a film at `path`. Fails at once if nothing can be written there.
    pub fn create(form: Form, path: &Path, format: Format) -> Result<Output, FilmError> {
        let begin =
            |path: &Path| AtomicFile::create(path).map_err(|error| cannot_write(path, error));
        let target = match form {
            Form::Folder => {
                fs::create_dir_all(path)
                    .map_err(|error| FilmError::Folder { path: path.to_path_buf(), error })?;
                drop(begin(&format.frame_path(path, format.part.start))?);
                FilmTarget::Folder
            }
            Form::AnimatedPng => FilmTarget::AnimatedPng(begin(path)?),
            Form::Gif => {
                gif::check(&format).map_err(|rule| FilmError::Form(rule.to_string()))?;
                FilmTarget::Gif(begin(path)?)
            }
            Form::Y4m => FilmTarget::Y4m(begin(path)?),
        };
        Ok(Output { target, path: path.to_path_buf(), format })
    }

    /// Writes all frames of the part.
    pub fn write(self, next: &mut NextPicture) -> Result<(), FilmError> {
        let Output { target, path, format } = self;
        match target {
            FilmTarget::Folder => write_folder(&path, &format, next),
            FilmTarget::AnimatedPng(file) => write_animated_png(file, &path, &format, next),
            FilmTarget::Gif(file) => gif::write(file, &path, &format, next),
            FilmTarget::Y4m(file) => write_y4m(file, &path, &format, next),
        }
    }
}

fn write_folder(folder: &Path, format: &Format, next: &mut NextPicture) -> Result<(), FilmError> {
    for frame in format.part.clone() {
        let path = format.frame_path(folder, frame);
        let bytes = picture::encoded(&*next(frame)?, "png").map_err(Error::other);
        bytes
            .and_then(|bytes| store::write_atomically(&path, &bytes))
            .map_err(|error| cannot_write(&path, error))?;
    }
    Ok(())
}

/// Writes an animated PNG that repeats forever. Viewers without animation show the first frame.
fn write_animated_png(
    file: AtomicFile,
    path: &Path,
    format: &Format,
    next: &mut NextPicture,
) -> Result<(), FilmError> {
    let failed = |error: EncodingError| match error {
        EncodingError::IoError(error) => cannot_write(path, error),
        error => cannot_write(path, Error::other(error)),
    };
    let mut buffer = BufWriter::with_capacity(BUFFER_BYTES, file);
    let mut encoder = Encoder::new(&mut buffer, format.size.x, format.size.y);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_animated(format.part.len() as u32, 0).map_err(failed)?;
    encoder.set_frame_delay(1, format.fps).map_err(failed)?;
    encoder.validate_sequence(true);
    let mut writer = encoder.write_header().map_err(failed)?;
    for frame in format.part.clone() {
        writer.write_image_data(&next(frame)?).map_err(failed)?;
    }
    writer.finish().map_err(failed)?;
    finish(buffer, path)
}

fn write_y4m(
    file: AtomicFile,
    path: &Path,
    format: &Format,
    next: &mut NextPicture,
) -> Result<(), FilmError> {
    let failed = |error| cannot_write(path, error);
    let mut buffer = BufWriter::with_capacity(BUFFER_BYTES, file);
    buffer.write_all(y4m::header(format.size, format.fps).as_bytes()).map_err(failed)?;
    let mut planes = Vec::new();
    for frame in format.part.clone() {
        y4m::write_planes(&*next(frame)?, &mut planes);
        buffer.write_all(y4m::FRAME).and_then(|()| buffer.write_all(&planes)).map_err(failed)?;
    }
    finish(buffer, path)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::sync::Arc;

    use glam::UVec2;
    use image::codecs::png::PngDecoder;
    use image::{AnimationDecoder, Rgb, RgbImage};

    use super::*;

    const FORMAT: Format = Format { size: UVec2::new(5, 3), fps: 25, frames: 12, part: 3..7 };

    fn frame(number: u32) -> Arc<RgbImage> {
        Arc::new(RgbImage::from_fn(5, 3, |x, y| Rgb([x as u8 * 40, y as u8 * 80, number as u8])))
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn names_say_what_a_film_becomes() {
        let folder = tempfile::tempdir().unwrap();
        let dotted = folder.path().join("v1.2");
        fs::create_dir(&dotted).unwrap();
        for (path, form) in [
            (Path::new("frames"), Form::Folder),
            (Path::new("a.mov/"), Form::Folder),
            (&dotted, Form::Folder),
            (Path::new("a.apng"), Form::AnimatedPng),
            (Path::new("b/a.PNG"), Form::AnimatedPng),
            (Path::new("a.gif"), Form::Gif),
            (Path::new("a.y4m"), Form::Y4m),
        ] {
            assert_eq!(Form::of(path), Ok(form), "{path:?}");
        }
        assert!(Form::of(Path::new("a.mp4")).unwrap_err().contains(".y4m"));
    }

    #[test]
    fn names_of_frames_sort_as_the_frames_do() {
        let names = |frames, frame| {
            let format = Format { frames, ..FORMAT };
            format.frame_path(Path::new("f"), frame).to_str().unwrap().to_string()
        };
        assert_eq!(names(120, 0), "f/frame-0001.png");
        assert_eq!(names(9999, 9998), "f/frame-9999.png");
        assert_eq!(names(10_000, 0), "f/frame-00001.png");
    }

    #[test]
    fn an_animated_png_has_every_frame_and_its_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let mut asked = Vec::new();
        let output = Output::create(Form::AnimatedPng, &path, FORMAT).unwrap();
        output
            .write(&mut |number| {
                asked.push(number);
                Ok(frame(number))
            })
            .unwrap();
        assert_eq!(asked, [3, 4, 5, 6]);
        let bytes = fs::read(&path).unwrap();
        let info = png::Decoder::new(Cursor::new(&bytes)).read_info().unwrap();
        let control = info.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (4, 0));
        let decoder = PngDecoder::new(Cursor::new(&bytes)).unwrap().apng().unwrap();
        let frames = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 4);
        for (number, read) in (3..7).zip(&frames) {
            assert_eq!(read.delay().numer_denom_ms(), (40, 1));
            let read = image::DynamicImage::from(read.buffer().clone()).to_rgb8();
            assert_eq!(read, *frame(number), "{number}");
        }
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn a_gif_has_every_frame_with_its_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gif");
        let write = || {
            let output = Output::create(Form::Gif, &path, FORMAT).unwrap();
            output.write(&mut |number| Ok(frame(number))).unwrap();
            fs::read(&path).unwrap()
        };
        let bytes = write();
        assert_eq!(bytes, write(), "the same film has the same bytes");
        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(Cursor::new(&bytes)).unwrap();
        assert_eq!((decoder.width(), decoder.height()), (5, 3));
        for number in 3..7 {
            let read = decoder.read_next_frame().unwrap().unwrap();
            assert_eq!(read.delay, 4);
            for (read, pixel) in read.buffer.chunks(4).zip(frame(number).pixels()) {
                let [r, g, b] = pixel.0;
                assert_eq!(read, [r, g, b, 255], "{number}: few colours are kept");
            }
        }
        assert!(decoder.read_next_frame().unwrap().is_none());
        assert_eq!(decoder.repeat(), ::gif::Repeat::Infinite);
    }

    #[test]
    fn raw_video_is_a_header_and_frames() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.y4m");
        let output = Output::create(Form::Y4m, &path, FORMAT).unwrap();
        output.write(&mut |number| Ok(frame(number))).unwrap();
        let bytes = fs::read(&path).unwrap();
        let header = y4m::header(FORMAT.size, 25);
        assert!(bytes.starts_with(header.as_bytes()));
        let frames = &bytes[header.len()..];
        assert_eq!(frames.len(), 4 * (6 + 3 * 15));
        let mut planes = Vec::new();
        for (number, read) in (3..7).zip(frames.chunks(6 + 3 * 15)) {
            y4m::write_planes(&frame(number), &mut planes);
            assert_eq!(read, [y4m::FRAME, &planes].concat(), "{number}");
        }
    }

    #[test]
    fn a_cancelled_film_leaves_whole_pictures_or_the_old_file() {
        for (form, name) in [
            (Form::Folder, "a"),
            (Form::AnimatedPng, "a.apng"),
            (Form::Gif, "a.gif"),
            (Form::Y4m, "a.y4m"),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            if form != Form::Folder {
                fs::write(&path, "old").unwrap();
            }
            let output = Output::create(form, &path, FORMAT).unwrap();
            let cancelled = output.write(&mut |number| match number {
                5 => Err(FilmError::Cancelled),
                _ => Ok(frame(number)),
            });
            assert!(matches!(cancelled, Err(FilmError::Cancelled)), "{cancelled:?}");
            assert_eq!(names(folder.path()), [name]);
            match form {
                Form::Folder => assert_eq!(names(&path), ["frame-0004.png", "frame-0005.png"]),
                _ => assert_eq!(fs::read(&path).unwrap(), b"old"),
            }
        }
    }
}

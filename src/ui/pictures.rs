//! The final pictures and films that a person can request: size, length and form of the file.
//!
//! Dialogs compose such a request; the program executes it. Knows neither files nor how pictures are made.

use glam::UVec2;

use crate::trace::TraceOptions;

/// The subject of a film.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum FilmSubject {
    #[default]
    Turntable,
    Lapse,
}

/// The form of the film's output.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum FilmForm {
    #[default]
    AnimatedPng,
    Gif,
    Y4m,
    Folder,
}

impl FilmForm {
    pub const ALL: [FilmForm; 4] =
        [FilmForm::AnimatedPng, FilmForm::Gif, FilmForm::Y4m, FilmForm::Folder];

    /// Returns the extension of its name; empty for a folder.
    pub const fn ending(self) -> &'static str {
        match self {
            FilmForm::AnimatedPng => "apng",
            FilmForm::Gif => "gif",
            FilmForm::Y4m => "y4m",
            FilmForm::Folder => "",
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            FilmForm::AnimatedPng => "Animated PNG",
            FilmForm::Gif => "GIF",
            FilmForm::Y4m => "Y4M video",
            FilmForm::Folder => "Folder of PNGs",
        }
    }

    pub const fn help(self) -> &'static str {
        match self {
            FilmForm::AnimatedPng => "Lossless; browsers show it",
            FilmForm::Gif => "256 colours per frame; works everywhere",
            FilmForm::Y4m => "Raw video for ffmpeg, mpv and VLC; large",
            FilmForm::Folder => "One picture per frame, for other programs",
        }
    }
}

/// A requested film.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FilmRequest {
    pub kind: FilmSubject,
    pub frames: u32,
    /// Frames per second.
    pub fps: u16,
    /// The angle by which the sculpture turns.
    pub spin_deg: f32,
    /// In pixels.
    pub size: UVec2,
    /// Samples per pixel, for smooth edges.
    pub samples: u32,
    pub form: FilmForm,
}

/// The file of a final picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum FinalFile {
    #[default]
    Png,
    Jpeg,
    Exr,
}

impl FinalFile {
    pub const ALL: [FinalFile; 3] = [FinalFile::Png, FinalFile::Jpeg, FinalFile::Exr];

    /// Returns the extension of its name.
    pub const fn ending(self) -> &'static str {
        match self {
            FinalFile::Png => "png",
            FinalFile::Jpeg => "jpg",
            FinalFile::Exr => "exr",
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            FinalFile::Png => "PNG",
            FinalFile::Jpeg => "JPEG",
            FinalFile::Exr => "OpenEXR",
        }
    }

    pub const fn help(self) -> &'static str {
        match self {
            FinalFile::Png => "For screens, lossless",
            FinalFile::Jpeg => "For screens, small",
            FinalFile::Exr => "Linear light with distance, colour and normals, for compositing",
        }
    }
}

/// A requested final picture.
#[derive(Clone, PartialEq, Debug)]
pub struct FinalRequest {
    /// In pixels.
    pub size: UVec2,
    pub trace: TraceOptions,
    pub denoise: bool,
    pub exposure_ev: f32,
    pub file: FinalFile,
    /// Renders on the graphics device, which shows voxels.
    pub on_gpu: bool,
}

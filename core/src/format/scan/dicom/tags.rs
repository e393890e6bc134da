//! The DICOM elements (PS3.6) from which a volume is made.

/// Group and element, 16 bits each.
pub type Tag = u32;

/// The group of the elements that describe a file itself.
pub const META_GROUP: u32 = 0x0002;
pub const TRANSFER_SYNTAX: Tag = 0x0002_0010;

pub const SERIES_DESCRIPTION: Tag = 0x0008_103E;
pub const MODALITY: Tag = 0x0008_0060;
pub const SERIES: Tag = 0x0020_000E;
pub const SERIES_NUMBER: Tag = 0x0020_0011;
pub const INSTANCE_NUMBER: Tag = 0x0020_0013;
pub const DIRECTORY_RECORDS: Tag = 0x0004_1220;

pub const SLICE_THICKNESS: Tag = 0x0018_0050;
pub const SPACING_BETWEEN_SLICES: Tag = 0x0018_0088;
/// For radiographs, at the detector.
pub const IMAGER_PIXEL_SPACING: Tag = 0x0018_1164;
pub const POSITION: Tag = 0x0020_0032;
pub const ORIENTATION: Tag = 0x0020_0037;
pub const PIXEL_SPACING: Tag = 0x0028_0030;
/// Distances of frames from the first, for radiation doses.
pub const FRAME_OFFSETS: Tag = 0x3004_000C;

pub const SAMPLES_PER_PIXEL: Tag = 0x0028_0002;
/// The values outside the field of the scanner, in stored numbers: one, or a range.
pub const PADDING: Tag = 0x0028_0120;
pub const PADDING_LIMIT: Tag = 0x0028_0121;
pub const PHOTOMETRIC: Tag = 0x0028_0004;
pub const PLANAR: Tag = 0x0028_0006;
pub const FRAMES: Tag = 0x0028_0008;
pub const ROWS: Tag = 0x0028_0010;
pub const COLUMNS: Tag = 0x0028_0011;
pub const BITS_ALLOCATED: Tag = 0x0028_0100;
pub const BITS_STORED: Tag = 0x0028_0101;
pub const HIGH_BIT: Tag = 0x0028_0102;
pub const IS_SIGNED: Tag = 0x0028_0103;
pub const INTERCEPT: Tag = 0x0028_1052;
pub const SLOPE: Tag = 0x0028_1053;

/// The functional groups that frames share, and those of each frame; items of both have the sequences below.
pub const SHARED_GROUPS: Tag = 0x5200_9229;
pub const FRAME_GROUPS: Tag = 0x5200_9230;
pub const POSITION_GROUP: Tag = 0x0020_9113;
pub const ORIENTATION_GROUP: Tag = 0x0020_9116;
pub const MEASURES_GROUP: Tag = 0x0028_9110;
pub const VALUES_GROUP: Tag = 0x0028_9145;
/// For nuclear medicine.
pub const DETECTORS: Tag = 0x0054_0022;

/// The attributes that distinguish slices at the same position: the time, phase, echo or kind to which they belong.
pub const PHASES: [Tag; 14] = [
    0x0020_0100, // temporal position
    0x0020_9241, // share of the heart's cycle
    0x0018_0086, // number of the echo
    0x0018_0081, // time of the echo
    0x0018_9087, // diffusion
    0x0018_1060, // time after the trigger
    0x0020_0012, // number of the acquisition
    0x0008_0008, // type of the image
    0x0018_9073, // length of the acquisition
    0x0054_1300, // time of the frame of reference
    0x0008_0032, // time of the acquisition
    0x0008_002A, // date and time of the acquisition
    0x0008_0033, // time of the content
    0x0020_9128, // temporal position of a frame
];
/// For a frame: its membership.
pub const CONTENT_GROUP: Tag = 0x0020_9111;

/// Sequences that are parsed in files that do not declare them as such.
pub const SEQUENCES: [Tag; 9] = [
    CONTENT_GROUP,
    SHARED_GROUPS,
    FRAME_GROUPS,
    POSITION_GROUP,
    ORIENTATION_GROUP,
    MEASURES_GROUP,
    VALUES_GROUP,
    DETECTORS,
    DIRECTORY_RECORDS,
];

pub const FLOAT_PIXELS: Tag = 0x7FE0_0008;
pub const DOUBLE_PIXELS: Tag = 0x7FE0_0009;
pub const WHOLE_PIXELS: Tag = 0x7FE0_0010;
pub const PIXELS: [Tag; 3] = [WHOLE_PIXELS, FLOAT_PIXELS, DOUBLE_PIXELS];

pub const ITEM: Tag = 0xFFFE_E000;
pub const ITEM_END: Tag = 0xFFFE_E00D;
pub const SEQUENCE_END: Tag = 0xFFFE_E0DD;

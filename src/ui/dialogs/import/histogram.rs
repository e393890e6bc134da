//! The histogram of a volume with two thresholds, which are dragged to choose the existing densities.
//!
//! Takes the densities and the existence rule; changes the thresholds of the options. Knows no voxels.

use egui::{Color32, CursorIcon, DragValue, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};

use crate::format::options::{Existence, ImportOptions};
use crate::format::{Existing, Histogram, VolumeStudy};

const HEIGHT: f32 = 84.0;
/// Number of distinct densities offered where they are not whole numbers.
const STEPS: f64 = 1000.0;
/// Colour of existing densities.
pub const CLAY: Color32 = Color32::from_rgb(0xe0, 0x86, 0x46);

/// The dragged threshold.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Handle {
    Lower,
    Upper,
}

/// Shows histogram and thresholds, `width` wide.
pub fn show(ui: &mut Ui, study: &VolumeStudy, options: &mut ImportOptions, width: f32) {
    let histogram = &study.densities.histogram;
    let existing = study.existing(options);
    let (rect, response) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::click_and_drag());
    let scale = Scale { rect, min: f64::from(histogram.min), max: f64::from(histogram.max) };
    let [low, high] = [existing.least, existing.most].map(|value| scale.x_of(value));
    if let Some(at) = response.interact_pointer_pos()
        && ui.is_enabled()
    {
        let id = response.id.with("dragged");
        let nearest = || {
            let is_lower = (at.x - low).abs() <= (at.x - high).abs();
            if is_lower && at.x <= high { Handle::Lower } else { Handle::Upper }
        };
        // By the point of the press: a fast hand is elsewhere when the drag begins.
        let handle = match ui.input(|input| input.pointer.any_pressed()) {
            true => nearest(),
            false => ui.data(|data| data.get_temp(id)).unwrap_or_else(nearest),
        };
        ui.data_mut(|data| data.insert_temp::<Handle>(id, handle));
        let to = rounded(scale.value_at(at.x), step(study));
        options.existence = dragged(existing, handle, to, histogram);
    }
    draw(ui, rect, &scale, histogram, study.existing(options));
    response
        .on_hover_cursor(CursorIcon::ResizeHorizontal)
        .on_hover_text("Frequency of each density (logarithmic). Drag the two thresholds");
    fields(ui, study, options);
}

/// Shows the thresholds as numbers, and the share of the voxels that exists.
fn fields(ui: &mut Ui, study: &VolumeStudy, options: &mut ImportOptions) {
    let histogram = &study.densities.histogram;
    let existing = study.existing(options);
    let (min, max) = (f64::from(histogram.min), f64::from(histogram.max));
    ui.horizontal_wrapped(|ui| {
        let mut auto = options.existence == Existence::Auto;
        let automatic = ui
            .checkbox(&mut auto, "Automatic")
            .on_hover_text("Thresholds that suit the histogram; for labels, all but 0");
        if automatic.changed() {
            let all = Existence::Threshold(existing.least.max(min));
            options.existence = if auto { Existence::Auto } else { all };
        }
        let ends = [existing.least.clamp(min, max), existing.most.clamp(min, max)];
        for (i, (name, handle)) in
            [("From", Handle::Lower), ("to", Handle::Upper)].into_iter().enumerate()
        {
            let label = ui.label(name);
            let mut value = ends[i];
            let range = if i == 0 { min..=ends[1] } else { ends[0]..=max };
            let field = DragValue::new(&mut value).range(range).speed((max - min) / 300.0);
            let field = ui.add(field).labelled_by(label.id).on_hover_text(match handle {
                Handle::Lower => "The lowest density that becomes a voxel",
                Handle::Upper => "The highest density that becomes a voxel",
            });
            if field.changed() {
                options.existence = dragged(existing, handle, value, histogram);
            }
        }
        ui.weak(format!("{:.1} % of the voxels", 100.0 * share(histogram, existing)));
    });
}

/// Returns the existence rule after a threshold is dragged to a density. A threshold dragged to its end is dropped.
fn dragged(existing: Existing, handle: Handle, to: f64, histogram: &Histogram) -> Existence {
    let (min, max) = (f64::from(histogram.min), f64::from(histogram.max));
    let (least, most) = match handle {
        Handle::Lower => (to.min(existing.most), existing.most),
        Handle::Upper => (existing.least, to.max(existing.least)),
    };
    let (least, most) = (least.clamp(min, max), most.clamp(min, max));
    if most >= max { Existence::Threshold(least) } else { Existence::Range(least, most) }
}

/// Returns the share of the finite densities that exist.
fn share(histogram: &Histogram, existing: Existing) -> f64 {
    let all: u64 = histogram.bins.iter().sum();
    let starts = (0..histogram.bins.len()).map(|bin| histogram.start_of(bin) as f32);
    let bins = starts.zip(&histogram.bins).filter(|(start, _)| existing.contains(*start));
    bins.map(|(_, count)| count).sum::<u64>() as f64 / all.max(1) as f64
}

/// Returns the step between densities: one for whole numbers, else a round number.
fn step(study: &VolumeStudy) -> f64 {
    let histogram = &study.densities.histogram;
    let range = f64::from(histogram.max) - f64::from(histogram.min);
    match histogram.bin_width {
        1.0 => 1.0,
        _ if range > 0.0 => 10f64.powf((range / STEPS).log10().floor()),
        _ => 1.0,
    }
}

fn rounded(value: f64, step: f64) -> f64 {
    // Divides if the step is below 1, so that 0.3 is not 0.30000000000000004.
    if step < 1.0 {
        let steps = (1.0 / step).round();
        (value * steps).round() / steps
    } else {
        (value / step).round() * step
    }
}

/// Returns the logarithms of the counts in `columns` equal parts of the range, scaled to 0 to 1.
fn columns(histogram: &Histogram, columns: usize) -> Vec<f32> {
    let mut counts = vec![0u64; columns];
    let bins = histogram.bins.len();
    for (bin, count) in histogram.bins.iter().enumerate() {
        // If there are fewer bins than columns, they are drawn as broad ones.
        let first = bin * columns / bins;
        let last = ((bin + 1) * columns / bins).clamp(first + 1, columns);
        counts[first..last].iter_mut().for_each(|sum| *sum += count);
    }
    let most = counts.iter().copied().max().unwrap_or(0).max(1);
    let log = |count: u64| ((1 + count) as f32).ln();
    counts.into_iter().map(|count| log(count) / log(most)).collect()
}

/// Maps densities to positions in the picture.
struct Scale {
    rect: Rect,
    min: f64,
    max: f64,
}

impl Scale {
    fn x_of(&self, value: f64) -> f32 {
        let range = self.max - self.min;
        let share = if range > 0.0 { (value - self.min) / range } else { 0.5 };
        self.rect.left() + self.rect.width() * share.clamp(0.0, 1.0) as f32
    }

    fn value_at(&self, x: f32) -> f64 {
        let share = f64::from((x - self.rect.left()) / self.rect.width().max(1.0));
        self.min + (self.max - self.min) * share.clamp(0.0, 1.0)
    }
}

fn draw(ui: &Ui, rect: Rect, scale: &Scale, histogram: &Histogram, existing: Existing) {
    let painter = ui.painter_at(rect.expand(1.0));
    let visuals = ui.visuals();
    painter.rect_filled(rect, 3.0, visuals.extreme_bg_color);
    let count = (rect.width() as usize).clamp(1, 1024);
    let step = rect.width() / count as f32;
    for (i, height) in columns(histogram, count).into_iter().enumerate() {
        let x = rect.left() + (i as f32 + 0.5) * step;
        let exists = existing.contains(scale.value_at(x) as f32);
        let colour = if exists { CLAY } else { visuals.weak_text_color() };
        let top = rect.bottom() - (rect.height() - 6.0) * height;
        painter.vline(x, top..=rect.bottom(), Stroke::new(step.max(1.0), colour));
    }
    for value in [existing.least, existing.most] {
        let x = scale.x_of(value);
        painter.vline(x, rect.y_range(), Stroke::new(1.5, visuals.strong_text_color()));
        let grip =
            [pos2(x - 5.0, rect.top()), pos2(x + 5.0, rect.top()), pos2(x, rect.top() + 8.0)];
        let fill = visuals.strong_text_color();
        painter.add(Shape::convex_polygon(grip.to_vec(), fill, Stroke::NONE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram(bins: &[u64], min: f32, width: f64) -> Histogram {
        let max = min + (bins.len() as f64 - 1.0) as f32 * width as f32;
        Histogram { min, max, bins: bins.to_vec(), bin_width: width }
    }

    #[test]
    fn thresholds_are_dragged_within_one_another_and_off_their_ends() {
        let bins = histogram(&[1; 101], -50.0, 1.0);
        let open = Existing { least: -10.0, most: f64::INFINITY, but_zero: false };
        let to = |existing, handle, value| dragged(existing, handle, value, &bins);
        assert_eq!(to(open, Handle::Lower, 7.0), Existence::Threshold(7.0));
        assert_eq!(to(open, Handle::Lower, -999.0), Existence::Threshold(-50.0));
        assert_eq!(to(open, Handle::Upper, 20.0), Existence::Range(-10.0, 20.0));
        assert_eq!(to(open, Handle::Upper, -30.0), Existence::Range(-10.0, -10.0));
        let both = Existing { most: 20.0, ..open };
        assert_eq!(to(both, Handle::Lower, 30.0), Existence::Range(20.0, 20.0));
        assert_eq!(to(both, Handle::Upper, 50.0), Existence::Threshold(-10.0));
        // The range of labels begins below every density.
        let all = Existing { least: f64::NEG_INFINITY, most: f64::INFINITY, but_zero: true };
        assert_eq!(to(all, Handle::Upper, 3.0), Existence::Range(-50.0, 3.0));
    }

    #[test]
    fn shares_and_columns_count_every_bin() {
        let bins = histogram(&[6, 0, 2, 2], 0.0, 1.0);
        let of = |least, most, but_zero| share(&bins, Existing { least, most, but_zero });
        assert_eq!(of(0.0, f64::INFINITY, false), 1.0);
        assert_eq!(of(f64::NEG_INFINITY, f64::INFINITY, true), 0.4);
        assert_eq!(of(2.0, 2.0, false), 0.2);
        assert_eq!(
            share(&histogram(&[], 0.0, 1.0), Existing { least: 0.0, most: 1.0, but_zero: false }),
            0.0
        );
        let few = columns(&bins, 8);
        assert_eq!((few[0], few[1], few[2], few.len()), (1.0, 1.0, 0.0, 8));
        assert!(few[4] > 0.0 && few[4] == few[7]);
        let many = columns(&histogram(&vec![1; 1000], 0.0, 1.0), 10);
        assert!(many.iter().all(|height| *height == 1.0), "{many:?}");
        assert_eq!(columns(&histogram(&[], 0.0, 1.0), 3), [0.0; 3]);
    }

    #[test]
    fn densities_are_round_numbers() {
        assert_eq!(rounded(0.31234, 0.1), 0.3);
        assert_eq!(rounded(1234.6, 1.0), 1235.0);
        assert_eq!(rounded(1234.6, 100.0), 1200.0);
        assert_eq!(rounded(-0.000_123_4, 0.000_01), -0.000_12);
    }
}

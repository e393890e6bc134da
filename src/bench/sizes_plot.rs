//! The plot of the benchmark of sizes: times against edges as SVG, both on logarithmic scales.

use std::fmt::Write;

use super::plot::{COLOURS, escape};
use super::sizes::{SizeReport, SizesReport};
use super::statistics::Times;

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 560.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 190.0;
const TOP: f64 = 64.0;
const BOTTOM: f64 = 50.0;
/// Shorter times are shown as this.
const LEAST_MS: f64 = 1e-4;

/// A measured time.
type SizeTime = fn(&SizeReport) -> Option<Times>;

const CURVES: [(&str, SizeTime); 5] = [
    ("edit", |size| size.edit),
    ("undo", |size| size.undo),
    ("sample", |size| size.sample),
    ("first picture", |size| size.first_picture),
    ("save", |size| size.save),
];

/// The places of edges and times in the plot.
struct Axes {
    /// Logarithms of the first and the last edge, to base 2, and of the least and the most milliseconds, to base 10.
    edges: [f64; 2],
    decades: [f64; 2],
}

impl Axes {
    /// Returns axes for all sizes, and for the times of those `shown`.
    fn of(report: &SizesReport, shown: &[&SizeReport]) -> Axes {
        let times =
            shown.iter().flat_map(|size| CURVES.iter().filter_map(move |(_, time)| time(size)));
        let (least, most) = times
            .map(|times| times.median_ms.max(LEAST_MS))
            .fold((f64::INFINITY, 0f64), |(least, most), ms| (least.min(ms), most.max(ms)));
        let low = if least <= most { least.log10().floor() } else { 0.0 };
        let edges = || report.sizes.iter().map(|size| f64::from(size.edge_vx).log2());
        Axes {
            edges: [edges().fold(f64::INFINITY, f64::min), edges().fold(0.0, f64::max)],
            decades: [low, most.max(LEAST_MS).log10().ceil().max(low + 1.0)],
        }
    }

    fn x(&self, edge: u32) -> f64 {
        let [first, last] = self.edges;
        let share = (f64::from(edge).log2() - first) / (last - first).max(1.0);
        LEFT + share * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, ms: f64) -> f64 {
        let [low, high] = self.decades;
        let share = (ms.max(LEAST_MS).log10() - low) / (high - low);
        HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM)
    }

    /// Returns the lines and numbers of both axes.
    fn svg(&self, report: &SizesReport) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        for decade in self.decades[0] as i32..=self.decades[1] as i32 {
            let ms = 10f64.powi(decade);
            let at = self.y(ms);
            let _ = write!(
                out,
                "<line x1=\"{LEFT}\" x2=\"{:.1}\" y1=\"{at:.1}\" y2=\"{at:.1}\" stroke=\"#ddd\"/>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#555\">{ms}</text>\n",
                WIDTH - RIGHT,
                LEFT - 8.0,
                at + 4.0,
            );
        }
        let mut known: Vec<u32> = report.sizes.iter().map(|size| size.edge_vx).collect();
        known.dedup();
        for edge in known {
            let _ = writeln!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#555\">{edge}</text>",
                self.x(edge),
                HEIGHT - BOTTOM + 22.0,
            );
        }
        out
    }
}

/// Returns a plot of the median times of each shape that was measured in several sizes.
pub fn svg(report: &SizesReport) -> String {
    let mut shapes: Vec<&str> = report.sizes.iter().map(|size| size.shape.as_str()).collect();
    shapes.sort_unstable();
    shapes.dedup();
    let of = |shape: &str| -> Vec<&SizeReport> {
        report.sizes.iter().filter(|size| size.shape == shape).collect()
    };
    shapes.retain(|shape| of(shape).len() > 1);
    let shown: Vec<&SizeReport> = shapes.iter().flat_map(|shape| of(shape)).collect();
    let axes = Axes::of(report, &shown);
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"16\" y=\"24\" font-size=\"16\">Time in ms (median) by the edge of the grid in voxels</text>\n\
         <text x=\"16\" y=\"44\" fill=\"#555\">{}; pictures of {}x{}</text>\n",
        escape(&report.machine.processor),
        report.picture[0],
        report.picture[1],
    );
    out += &axes.svg(report);
    let mut line = 0;
    for (number, shape) in shapes.iter().enumerate() {
        // The first shape has solid lines, the others dashed ones.
        let dashes = if number == 0 { String::new() } else { format!("{0} {0}", 3 * number + 3) };
        for ((name, time), colour) in CURVES.iter().zip(COLOURS) {
            let points: Vec<String> = of(shape)
                .into_iter()
                .filter_map(|size| Some((axes.x(size.edge_vx), axes.y(time(size)?.median_ms))))
                .map(|(x, y)| format!("{x:.1},{y:.1}"))
                .collect();
            let (key, right) = (TOP + 20.0 * f64::from(line), WIDTH - RIGHT + 14.0);
            let style =
                format!("stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"{dashes}\"");
            let _ = write!(
                out,
                "<polyline points=\"{}\" fill=\"none\" {style}/>\n\
                 <line x1=\"{right}\" x2=\"{:.1}\" y1=\"{key:.1}\" y2=\"{key:.1}\" {style}/>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\">{name}, {}</text>\n",
                points.join(" "),
                right + 24.0,
                right + 30.0,
                key + 4.0,
                escape(shape.split(',').next().unwrap_or(shape)),
            );
            line += 1;
        }
    }
    out.push_str("</svg>\n");
    out
}

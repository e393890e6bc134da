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

/// A measured time.
type SizeTime = fn(&SizeReport) -> Option<Times>;

const CURVES: [(&str, SizeTime); 5] = [
    ("edit", |size| size.edit),
    ("undo", |size| size.undo),
    ("sample", |size| size.sample),
    ("first picture", |size| size.first_picture),
    ("save", |size| size.save),
];

/// Returns a plot of the median times of each shape that was measured in several sizes.
pub fn svg(report: &SizesReport) -> String {
    let mut shapes: Vec<&str> = report.sizes.iter().map(|size| size.shape.as_str()).collect();
    shapes.dedup();
    shapes.sort_unstable();
    shapes.dedup();
    let of = |shape: &str| -> Vec<&SizeReport> {
        report.sizes.iter().filter(|size| size.shape == shape).collect()
    };
    shapes.retain(|shape| of(shape).len() > 1);
    let times = || {
        let shown = report.sizes.iter().filter(|size| shapes.contains(&size.shape.as_str()));
        shown.flat_map(|size| CURVES.iter().filter_map(move |(_, time)| time(size)))
    };
    let (least, most) = times()
        .map(|times| times.median_ms.max(1e-4))
        .fold((f64::INFINITY, 0f64), |(least, most), ms| (least.min(ms), most.max(ms)));
    let (low, high) = match least <= most {
        true => (least.log10().floor(), most.log10().ceil().max(least.log10().floor() + 1.0)),
        false => (0.0, 1.0),
    };
    let edges = || report.sizes.iter().map(|size| f64::from(size.edge_vx).log2());
    let (first, last) = (edges().fold(f64::INFINITY, f64::min), edges().fold(0.0, f64::max));
    let x = |edge: u32| {
        let share = (f64::from(edge).log2() - first) / (last - first).max(1.0);
        LEFT + share * (WIDTH - LEFT - RIGHT)
    };
    let y = |ms: f64| {
        let share = (ms.max(1e-4).log10() - low) / (high - low);
        HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM)
    };
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
    for decade in low as i32..=high as i32 {
        let (ms, at) = (10f64.powi(decade), y(10f64.powi(decade)));
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
            x(edge),
            HEIGHT - BOTTOM + 22.0,
        );
    }
    let mut line = 0;
    for (number, shape) in shapes.iter().enumerate() {
        // The first shape has solid lines, the others dashed ones.
        let dashes = if number == 0 { String::new() } else { format!("{0} {0}", 3 * number + 3) };
        for ((name, time), colour) in CURVES.iter().zip(COLOURS) {
            let points: Vec<String> = of(shape)
                .into_iter()
                .filter_map(|size| Some((x(size.edge_vx), y(time(size)?.median_ms))))
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

//! The plot of a benchmark: a bar per mode, grouped by scene, as SVG. The scale is logarithmic,
//! since modes differ by orders of magnitude.

use std::fmt::Write;

use super::report::BenchReport;

const WIDTH: f64 = 900.0;
const LEFT: f64 = 240.0;
const RIGHT: f64 = 90.0;
const BAR: f64 = 20.0;
const GAP: f64 = 26.0;
const TOP: f64 = 64.0;
pub(super) const COLOURS: [&str; 8] =
    ["#3b6ea5", "#d08c3a", "#5a9a5f", "#b5534f", "#7a64a8", "#7d7d7d", "#3f9a98", "#b86aa0"];

/// Returns a plot of the median frame of each mode in each scene.
pub fn svg(report: &BenchReport) -> String {
    let frames = || report.scenes.iter().flat_map(|s| &s.modes).map(|m| m.frame.median_ms);
    let least = frames().fold(f64::INFINITY, f64::min).clamp(1e-3, 1e4);
    let most = frames().fold(least, f64::max);
    let (low, high) = (least.log10().floor(), most.log10().ceil().max(least.log10().floor() + 1.0));
    let x = |ms: f64| LEFT + (ms.max(1e-3).log10() - low) / (high - low) * (WIDTH - LEFT - RIGHT);
    let bars: usize = report.scenes.iter().map(|s| s.modes.len()).sum();
    let height = TOP + bars as f64 * BAR + report.scenes.len() as f64 * GAP + 30.0;
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"16\" y=\"24\" font-size=\"16\">Time to {} of {}x{} in ms (median)</text>\n\
         <text x=\"16\" y=\"44\" fill=\"#555\">{}; {}</text>\n",
        if report.eyes == 1 { "a picture" } else { "two pictures" },
        report.picture[0],
        report.picture[1],
        escape(&report.machine.processor),
        escape(&report.machine.vulkan),
    );
    for decade in low as i32..=high as i32 {
        for step in [1.0, 2.0, 5.0] {
            let ms = step * 10f64.powi(decade);
            let at = x(ms);
            if at > WIDTH - RIGHT + 0.5 {
                continue;
            }
            let bottom = height - 30.0;
            let _ = write!(
                out,
                "<line x1=\"{at:.1}\" x2=\"{at:.1}\" y1=\"{TOP}\" y2=\"{bottom}\" stroke=\"#ddd\"/>\n\
                 <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"#555\">{ms}</text>\n",
                bottom + 18.0,
            );
        }
    }
    let mut modes: Vec<&str> = Vec::new();
    let mut y = TOP;
    for scene in &report.scenes {
        y += GAP;
        let name = escape(&scene.name);
        let _ =
            writeln!(out, "<text x=\"16\" y=\"{:.1}\" font-weight=\"bold\">{name}</text>", y - 7.0);
        for mode in &scene.modes {
            let colour = match modes.iter().position(|m| *m == mode.mode) {
                Some(at) => at,
                None => {
                    modes.push(&mode.mode);
                    modes.len() - 1
                }
            };
            let (ms, middle) = (mode.frame.median_ms, y + BAR * 0.5 + 4.0);
            let (end, fill) = (x(ms), COLOURS[colour % COLOURS.len()]);
            let _ = write!(
                out,
                "<text x=\"{:.1}\" y=\"{middle:.1}\" text-anchor=\"end\">{}</text>\n\
                 <rect x=\"{LEFT}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{fill}\"/>\n\
                 <text x=\"{:.1}\" y=\"{middle:.1}\">{ms:.2}</text>\n",
                LEFT - 8.0,
                escape(&mode.mode),
                y + 2.0,
                end - LEFT,
                BAR - 4.0,
                end + 6.0,
            );
            y += BAR;
        }
    }
    out.push_str("</svg>\n");
    out
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

//! The result as a picture: one panel for each load, one line for each row, time to the right on a
//! logarithmic scale, the floor as lines from top to bottom.

use std::fmt::Write as _;

use super::results::{FloorRow, RecoveryRow, Results};
use crate::commands::bench::drawing::line;
use crate::commands::bench::percentiles::Percentiles;

const LABELS_WIDTH: f64 = 280.0;
const PANEL_WIDTH: f64 = 270.0;
const GAP: f64 = 44.0;
const ROW_HEIGHT: f64 = 16.0;
/// Title, loads, and names of the floor.
const TOP: f64 = 130.0;
/// Axis and legend.
const BOTTOM: f64 = 90.0;
/// Title and legend need so much, however few panels there are.
const LEAST_WIDTH: f64 = 860.0;
/// From one name of the floor to the next, downwards.
const FLOOR_NAME_HEIGHT: f64 = 13.0;
/// One hue for each fault, in the order of the rows.
const HUES: [&str; 6] = [
    "#08519c", "#6a3d9a", "#a63603", "#006d2c", "#b8860b", "#4d4d4d",
];
/// The 20 ms of Ahn et al. (2012), in microseconds.
const PAPER_US: f64 = 20_000.0;

/// Whole decades of microseconds, as many as the figures need.
struct Scale {
    least: f64,
    most: f64,
}

/// The picture as SVG.
pub(super) fn draw(results: &Results) -> String {
    let rows = row_names(results);
    let scale = Scale::of(results);
    let panels = results.loads.len() as f64;
    let width = (LABELS_WIDTH + panels * (PANEL_WIDTH + GAP) + GAP).max(LEAST_WIDTH);
    let bottom = TOP + ROW_HEIGHT * rows.len() as f64;
    let height = bottom + BOTTOM;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{width:.0}\" height=\"{height:.0}\" fill=\"white\"/>\n"
    );
    let title = "From the fault until the component works again: median, 99 %, 99.9 %, longest";
    text(&mut svg, [GAP, 24.0], "start", "#000000", 16, title);
    let machine = results.machine.to_string();
    text(&mut svg, [GAP, 44.0], "start", "#444444", 12, &machine);
    draw_labels(&mut svg, &rows);
    for (index, load) in results.loads.iter().enumerate() {
        let left = LABELS_WIDTH + index as f64 * (PANEL_WIDTH + GAP);
        let panel = Panel {
            left,
            bottom,
            scale: &scale,
        };
        let name = format!("load {} %", load.load_percent);
        let middle = left + PANEL_WIDTH / 2.0;
        text(&mut svg, [middle, 66.0], "middle", "#000000", 14, &name);
        panel.draw_axis(&mut svg);
        let floor = results.floor.iter();
        let floor = floor.filter(|row| row.load_percent == load.load_percent);
        panel.draw_floor(&mut svg, floor.collect());
        for row in (results.rows.iter()).filter(|row| row.load_percent == load.load_percent) {
            if let Some(place) = rows.iter().position(|name| *name == names_of(row)) {
                panel.draw_row(&mut svg, place, hue(&rows, row.fault), &row.total_us);
            }
        }
    }
    draw_legend(&mut svg, bottom);
    svg.push_str("</svg>\n");
    svg
}

/// Tier, fault and handling.
type Names = [&'static str; 3];

fn names_of(row: &RecoveryRow) -> Names {
    [row.tier, row.fault, row.handling]
}

/// What each line stands for, from the top.
fn row_names(results: &Results) -> Vec<Names> {
    let mut names = Vec::new();
    for row in &results.rows {
        if !names.contains(&names_of(row)) {
            names.push(names_of(row));
        }
    }
    names
}

/// The hue of a fault: by its place among the faults of the picture.
fn hue(rows: &[Names], fault: &str) -> &'static str {
    let mut faults: Vec<&str> = rows.iter().map(|[_, fault, _]| *fault).collect();
    faults.sort_unstable();
    faults.dedup();
    let place = faults.iter().position(|it| *it == fault);
    HUES[place.unwrap_or_default() % HUES.len()]
}

fn draw_labels(svg: &mut String, rows: &[Names]) {
    for (place, [tier, fault, handling]) in rows.iter().enumerate() {
        let y = row_y(place) + 4.0;
        let words = format!("{} {}", fault.replace('_', " "), handling.replace('_', " "));
        let words = match *tier {
            "guarded" => words,
            tier => format!("{tier}: {words}"),
        };
        let x = LABELS_WIDTH - 10.0;
        text(svg, [x, y], "end", hue(rows, fault), 12, &words);
    }
}

fn draw_legend(svg: &mut String, bottom: f64) {
    let y = bottom + 52.0;
    let x = LABELS_WIDTH;
    let _infallible = writeln!(
        svg,
        "<line x1=\"{x}\" y1=\"{y}\" x2=\"{:.0}\" y2=\"{y}\" stroke=\"#444444\" stroke-width=\"2\"/>\n\
         <circle cx=\"{x}\" cy=\"{y}\" r=\"4\" fill=\"#444444\"/>\n\
         <line x1=\"{:.0}\" y1=\"{:.0}\" x2=\"{:.0}\" y2=\"{:.0}\" stroke=\"#444444\" stroke-width=\"2\"/>\n\
         <circle cx=\"{:.0}\" cy=\"{y}\" r=\"3\" fill=\"white\" stroke=\"#444444\"/>",
        x + 60.0,
        x + 35.0,
        y - 4.0,
        x + 35.0,
        y + 4.0,
        x + 90.0
    );
    let words = "dot: median; stroke: 99 %; end of the line: 99.9 %; circle: longest";
    text(svg, [x + 104.0, y + 4.0], "start", "#444444", 12, words);
    let words = "from top to bottom: medians of the floor, and the 20 ms of Ahn et al. (2012)";
    text(svg, [x + 104.0, y + 22.0], "start", "#444444", 12, words);
}

/// One load.
struct Panel<'scale> {
    left: f64,
    bottom: f64,
    scale: &'scale Scale,
}

impl Panel<'_> {
    fn draw_axis(&self, svg: &mut String) {
        let mut us = self.scale.least;
        while us <= self.scale.most * 1.001 {
            let x = self.x(us);
            line(svg, [x, TOP, x, self.bottom], "#dddddd", "");
            let name = match us {
                _ if us >= 1e6 => format!("{} s", us / 1e6),
                _ if us >= 1e3 => format!("{} ms", us / 1e3),
                _ => format!("{us} us"),
            };
            let place = [x, self.bottom + 16.0];
            text(svg, place, "middle", "#000000", 11, &name);
            us *= 10.0;
        }
        if self.scale.most > PAPER_US {
            let x = self.x(PAPER_US);
            line(svg, [x, TOP, x, self.bottom], "#cc0000", "6 4");
            let place = [x, self.bottom + 30.0];
            text(svg, place, "middle", "#cc0000", 11, "20 ms");
        }
    }

    fn draw_floor(&self, svg: &mut String, mut floor: Vec<&FloorRow>) {
        // The farther to the right the lower: so no line goes through another one's name.
        floor.sort_by(|one, other| other.us.p50.total_cmp(&one.us.p50));
        for (index, row) in floor.iter().enumerate() {
            let x = self.x(row.us.p50);
            let y = TOP - 6.0 - FLOOR_NAME_HEIGHT * index as f64;
            line(svg, [x, y + 2.0, x, self.bottom], "#000000", "2 3");
            let name = format!("{} {:.0} us", row.name.replace('_', " "), row.us.p50);
            text(svg, [x + 3.0, y], "start", "#000000", 10, &name);
        }
    }

    fn draw_row(&self, svg: &mut String, place: usize, hue: &str, us: &Percentiles) {
        let y = row_y(place);
        let [median, p99, p999, longest] = [us.p50, us.p99, us.p999, us.max].map(|us| self.x(us));
        let _infallible = writeln!(
            svg,
            "<line x1=\"{median:.1}\" y1=\"{y:.1}\" x2=\"{p999:.1}\" y2=\"{y:.1}\" stroke=\"{hue}\" \
             stroke-width=\"2\"/>\n\
             <line x1=\"{p99:.1}\" y1=\"{:.1}\" x2=\"{p99:.1}\" y2=\"{:.1}\" stroke=\"{hue}\" \
             stroke-width=\"2\"/>\n\
             <circle cx=\"{median:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{hue}\"/>\n\
             <circle cx=\"{longest:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"white\" stroke=\"{hue}\"/>",
            y - 4.0,
            y + 4.0
        );
    }

    fn x(&self, us: f64) -> f64 {
        let share = (us.max(self.scale.least) / self.scale.least).ln()
            / (self.scale.most / self.scale.least).ln();
        self.left + share.min(1.0) * PANEL_WIDTH
    }
}

impl Scale {
    fn of(results: &Results) -> Self {
        let rows = results.rows.iter().map(|row| row.total_us);
        let floor = results.floor.iter().map(|row| row.us);
        let (mut least, mut most) = (10.0_f64, 1000.0_f64);
        for us in rows.chain(floor) {
            least = least.min(us.p50.max(0.1));
            most = most.max(us.max);
        }
        Self {
            least: 10_f64.powf(least.log10().floor()),
            most: 10_f64.powf(most.log10().ceil()),
        }
    }
}

fn row_y(place: usize) -> f64 {
    TOP + ROW_HEIGHT * (place as f64 + 0.5)
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, colour: &str, size: u32, text: &str) {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    let _infallible = writeln!(
        svg,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\" \
         font-size=\"{size}\">{text}</text>"
    );
}

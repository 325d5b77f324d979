//! The result as a picture: components to the right, time upwards, both logarithmic, one line for
//! each tier and set of rules.

use std::fmt::Write as _;

use super::extent::TIERS;
use super::rules::Rules;
use super::study::{ChainRow, Study};
use super::times::Times;
use crate::commands::bench::drawing::{line, text};

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 480.0;
const TOP: f64 = 74.0;
const BOTTOM: f64 = 400.0;
/// Left ends of the panels, and how wide each is.
const PANELS: [f64; 2] = [70.0, 490.0];
const PANEL_WIDTH: f64 = 330.0;
/// One hue for each tier: without rules, with all.
const COLOURS: [[&str; 2]; 2] = [["#4292c6", "#08519c"], ["#f16913", "#a63603"]];

/// What a panel shows of a chain.
type Quantity = fn(&ChainRow) -> &Times;

/// One of the two panels.
struct Panel {
    left: f64,
    /// Decades of nanoseconds at the ends of its upward axis.
    decades: [i32; 2],
    /// The largest number of components.
    most: f64,
}

/// The picture as SVG.
pub(super) fn draw(study: &Study) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    let title =
        "What fault tolerance costs while nothing fails: chains of components on one thread";
    text(&mut svg, PANELS[0], 26.0, "start", title);
    let panels: [(f64, &str, Quantity); 2] = [
        (PANELS[0], "Time of a cycle, free running", |row| &row.cycle),
        (PANELS[1], "First write to last read, at 1 kHz", |row| {
            &row.latency
        }),
    ];
    for (left, title, of) in panels {
        let panel = Panel::around(left, study, of);
        text(&mut svg, left, 58.0, "start", title);
        panel.axes(&mut svg, study);
        for (tier, colours) in TIERS.into_iter().zip(COLOURS) {
            for (rules, colour) in [Rules::None, Rules::All].into_iter().zip(colours) {
                let rows = study.chains.iter();
                let rows = rows.filter(|row| row.tier == tier && row.rules == rules);
                panel.curve(&mut svg, rows.map(|row| (row.components, *of(row))), colour);
            }
        }
    }
    legend(&mut svg);
    svg.push_str("</svg>\n");
    svg
}

impl Panel {
    fn around(left: f64, study: &Study, of: Quantity) -> Self {
        let rows = study.chains.iter();
        let times = rows.flat_map(|row| of(row).percentiles_ns[..2].iter().copied());
        let (least, longest) = times.fold((u64::MAX, 1), |(least, longest), time| {
            (least.min(time.max(1)), longest.max(time))
        });
        let most = study.chains.iter().map(|row| row.components).max();
        let decades = [
            (least.min(longest) as f64).log10().floor() as i32,
            (longest as f64).log10().ceil() as i32,
        ];
        Self {
            left,
            decades: [decades[0], decades[1].max(decades[0] + 1)],
            most: most.unwrap_or(1).max(2) as f64,
        }
    }

    fn x(&self, components: f64) -> f64 {
        self.left + components.ln() / self.most.ln() * PANEL_WIDTH
    }

    fn y(&self, time_ns: f64) -> f64 {
        let [low, high] = self.decades.map(f64::from);
        BOTTOM - (time_ns.log10() - low) / (high - low) * (BOTTOM - TOP)
    }

    fn axes(&self, svg: &mut String, study: &Study) {
        let right = self.left + PANEL_WIDTH;
        for decade in self.decades[0]..=self.decades[1] {
            let y = self.y(10f64.powi(decade));
            line(svg, [self.left, y, right, y], "#dddddd", "");
            text(svg, self.left - 8.0, y + 4.0, "end", &written(decade));
        }
        let mut lengths: Vec<usize> = study.chains.iter().map(|row| row.components).collect();
        lengths.dedup();
        for components in lengths {
            let x = self.x(components as f64);
            line(svg, [x, TOP, x, BOTTOM], "#eeeeee", "");
            text(svg, x, BOTTOM + 18.0, "middle", &components.to_string());
        }
        let middle = self.left + PANEL_WIDTH / 2.0;
        text(
            svg,
            middle,
            BOTTOM + 38.0,
            "middle",
            "components in the chain",
        );
    }

    /// The median as a line, the 99th percentile dashed.
    fn curve(
        &self,
        svg: &mut String,
        points: impl Iterator<Item = (usize, Times)> + Clone,
        colour: &str,
    ) {
        for (which, dash) in ["", "5 4"].into_iter().enumerate() {
            let mut path = String::new();
            for (components, times) in points.clone() {
                let (x, y) = (
                    self.x(components as f64),
                    self.y(times.percentiles_ns[which] as f64),
                );
                let _infallible = write!(path, "{x:.1},{y:.1} ");
            }
            let _infallible = writeln!(
                svg,
                "<polyline points=\"{path}\" fill=\"none\" stroke=\"{colour}\" \
                 stroke-width=\"1.8\" stroke-dasharray=\"{dash}\"/>"
            );
        }
    }
}

/// A decade of nanoseconds, in the unit that a person would use.
fn written(decade: i32) -> String {
    let units = ["ns", "us", "ms", "s"];
    let unit = usize::try_from(decade / 3).unwrap_or_default().min(3);
    format!(
        "{} {}",
        10u32.pow(decade.rem_euclid(3).cast_unsigned()),
        units[unit]
    )
}

fn legend(svg: &mut String) {
    let mut x = PANELS[0];
    let y = HEIGHT - 14.0;
    for (tier, colours) in TIERS.into_iter().zip(COLOURS) {
        for (rules, colour) in ["no rules", "all rules"].into_iter().zip(colours) {
            line(svg, [x, y - 4.0, x + 25.0, y - 4.0], colour, "");
            text(svg, x + 31.0, y, "start", &format!("{tier}, {rules}"));
            x += 165.0;
        }
    }
    text(svg, WIDTH - 20.0, y, "end", "dashed: 99th percentile");
}

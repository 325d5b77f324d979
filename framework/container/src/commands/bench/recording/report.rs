//! The result, for a person.

use std::io::{self, Write};

use super::Study;

/// Writes the result.
pub(super) fn write(output: &mut impl Write, study: &Study) -> io::Result<()> {
    writeln!(output, "{}\n", study.machine)?;
    writeln!(
        output,
        "processor time, ms/s   without   with   of it the writer   cost"
    )?;
    for (number, round) in study.rounds.iter().enumerate() {
        let [without, with, writer] = round.figures();
        writeln!(
            output,
            "  round {:<2}            {without:8.2} {with:6.2} {writer:19.2} {:5.1} %",
            number + 1,
            round.cost_percent()
        )?;
    }
    writeln!(output, "  median cost: {:.1} %\n", study.cost_percent)?;
    let flood = &study.flood;
    writeln!(
        output,
        "usual: {:.0} data/s, {:.0} kB/s; for {:.1} s a hundred times that:",
        flood.usual_hz,
        flood.usual_bytes_per_s / 1e3,
        flood.duration_s
    )?;
    writeln!(
        output,
        "  sent {}, recorded {}, said to be dropped {} ({:.3} %), unaccounted for {}; file of {:.0} MB",
        flood.sent,
        flood.recorded,
        flood.dropped,
        100.0 * flood.dropped as f64 / flood.sent.max(1) as f64,
        i128::from(flood.sent) - i128::from(flood.recorded) - i128::from(flood.dropped),
        flood.file_bytes as f64 / 1e6
    )?;
    output.flush()
}

//! An answer for people: the lines that matter. All of it is in answer.json and on the page.

use super::answer::{Answer, Found, Standing};
use super::{formats, refusal};
use crate::machine::config::Config;
use crate::report::table::psnr_text;

/// Limits that are named: the tightest.
const NAMED: usize = 3;

impl Answer {
    /// The whole answer in some ten lines.
    pub fn text(&self) -> String {
        if !self.ruled_out.is_empty() {
            return refusal::text(&self.ruled_out);
        }
        let Some((first, next)) = self.found.split_first() else {
            return String::new();
        };
        let mut text = format!(
            "{}: of {} machines and {} designs, on {} of {} frames\n",
            if self.holds {
                "cheapest point that holds all limits"
            } else {
                "no point was found that holds all limits; this one misses them least"
            },
            self.points,
            self.designs,
            self.frames[0],
            self.frames[1]
        );
        if !self.searched_designs {
            text += "the design was kept: no limit on its error (--max-error, --psnr) or no widths in the space\n";
        }
        text += &point(first);
        if self.holds {
            text += &self.margins();
            text += &nexts(first, next);
        } else {
            text += &self.limits();
            text += &self.failing();
        }
        text + &formats::text(&self.formats)
    }

    /// The tightest limits, and what the answer would cost without them.
    fn margins(&self) -> String {
        let mut all: Vec<&Standing> = self.standings.iter().collect();
        all.sort_by(|a, b| a.slack.total_cmp(&b.slack));
        let cost = self.found.first().map_or(0.0, |found| found.reached.cost());
        let margin = |standing: &&Standing| {
            let quantity = standing.limit.quantity;
            let without = standing.cost_without.filter(|without| *without < cost);
            let without = without.map_or(String::new(), |without| {
                format!(", {} LUT in all without it", per_cent(without / cost - 1.0))
            });
            format!(
                "{} {} of {} ({} left{without})",
                quantity.name(),
                quantity.show(standing.value),
                quantity.show(standing.limit.bound),
                per_cent(standing.slack)
            )
        };
        let named: Vec<String> = all.iter().take(NAMED).map(margin).collect();
        format!("  tightest  {}\n", named.join("\n            "))
    }

    fn limits(&self) -> String {
        let mut text = format!(
            "  {:<22} {:>12} {:>12} {:>9}  of\n",
            "limit", "bound", "reached", "left"
        );
        for standing in &self.standings {
            let limit = &standing.limit;
            text += &format!(
                "  {:<22} {:>12} {:>12} {:>9}  {}\n",
                limit.quantity.name(),
                limit.quantity.show(limit.bound),
                limit.quantity.show(standing.value),
                per_cent(standing.slack),
                limit.of
            );
        }
        text
    }

    /// Which limit would have to give way, by how much.
    fn failing(&self) -> String {
        let missed = |one: &Standing| one.missed_alone.filter(|missed| *missed > 0.0);
        let alone = self.standings.iter();
        let alone = alone.filter_map(|standing| Some((standing, missed(standing)?)));
        let mut alone: Vec<(&Standing, f64)> = alone.collect();
        alone.sort_by(|a, b| a.1.total_cmp(&b.1));
        let Some(((first, missed), others)) = alone.split_first() else {
            return "more than one limit fails: no point looked at misses only one of them\n"
                .to_owned();
        };
        let mut text = format!(
            "the first limit to fail is {} ({}): with all others held it is missed by {}\n",
            first.limit.quantity.name(),
            first.limit.of,
            per_cent(*missed)
        );
        for (standing, missed) in others {
            text += &format!(
                "  {} ({}) in its place: missed by {}\n",
                standing.limit.quantity.name(),
                standing.limit.of,
                per_cent(*missed)
            );
        }
        text
    }
}

/// A part in per cent; of a bound of nearly nothing, or of identical pictures' infinite PSNR, only that it is large.
fn per_cent(part: f64) -> String {
    match 100.0 * part {
        share if share.is_nan() => "unknown".to_owned(),
        share if share.abs() <= 9999.0 => format!("{share:.1} %"),
        share if share < 0.0 => "< -9999 %".to_owned(),
        _ => "> 9999 %".to_owned(),
    }
}

/// What the next points cost more, in one line; nothing if there are none.
fn nexts(first: &Found, next: &[Found]) -> String {
    let one = |found: &Found| {
        format!(
            "+{} LUT in all for {:.1} frames a second",
            per_cent(found.reached.cost() / first.reached.cost() - 1.0),
            found.reached.pace.frames_per_s
        )
    };
    let all: Vec<String> = next.iter().map(one).collect();
    if all.is_empty() {
        return String::new();
    }
    format!("  next      {}\n", all.join("; "))
}

/// A point in a few lines, its machine by what decides area and pace; the rest is in machine.toml.
fn point(found: &Found) -> String {
    let (design, machine, reached) = (&found.design, &found.machine, &found.reached);
    let widths = design.widths.iter();
    let widths: Vec<String> = widths
        .map(|(name, bits)| format!("{name} {bits}"))
        .collect();
    let (some, others) = widths.split_at(widths.len() / 2);
    let pace = &reached.pace;
    let error = reached.error.map_or(String::new(), |error| {
        format!(
            "; PSNR {}, largest error {:.3e}, bias {:+.2e}",
            psnr_text(error.psnr_db()),
            error.max_abs,
            error.bias
        )
    });
    format!(
        "  cost      {:.0} LUT in all: {}\n  \
           pace      {:.2} frames a second at {} MHz{}, limited by {}{error}\n  \
           moves     {:.2} MB a frame, {:.0} MB a second; {:.3} mJ a frame (estimate)\n  \
           design    {},\n            {} ({}, {})\n  \
           machine   {}, {} + {} bytes a cycle; -o DIR for all of it\n",
        reached.cost(),
        reached.area.raster + reached.area.around,
        pace.frames_per_s,
        pace.clock.mhz,
        if pace.clock.assumed { " (assumed)" } else { "" },
        pace.limited_by,
        pace.bytes_per_frame as f64 / 1e6,
        pace.bytes_per_s / 1e6,
        reached.millijoules,
        some.join(", "),
        others.join(", "),
        design.rounding,
        design.traversal,
        units_of(machine),
        machine.read_bandwidth,
        machine.write_bandwidth
    )
}

/// Its units, without its channels.
pub(super) fn units_of(machine: &Config) -> String {
    format!(
        "{} raster unit(s) of {} lane(s), tiles of {} x {}, a splat in {} cycles",
        machine.raster_units,
        machine.lanes,
        machine.tile_width,
        machine.tile_height,
        machine.setup_interval
    )
}

#[cfg(test)]
mod tests {
    use super::per_cent;

    #[test]
    fn no_share_is_infinite() {
        let shown = [0.125, -0.5, f64::INFINITY, f64::NEG_INFINITY, f64::NAN].map(per_cent);
        assert_eq!(
            shown,
            ["12.5 %", "-50.0 %", "> 9999 %", "< -9999 %", "unknown"]
        );
    }
}

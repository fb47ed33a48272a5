//! An answer for people.

use super::answer::{Answer, Found, Standing};
use crate::machine::config::{Config, SETTINGS};
use std::fmt::Write;

impl Answer {
    /// The whole answer; machines are told by what they have otherwise than `usual`.
    pub fn text(&self, usual: &Config) -> String {
        let mut text = format!(
            "{} points and {} designs looked at, on {} of {} frames\n",
            self.points, self.designs, self.frames[0], self.frames[1]
        );
        if !self.searched_designs {
            text += "the design was kept: no limit on its error (--max-error, --psnr) or no widths in the space\n";
        }
        let Some((first, next)) = self.found.split_first() else {
            return text;
        };
        text += if self.holds {
            "\ncheapest point that holds all limits\n"
        } else {
            "\nno point was found that holds all limits; this one misses them least\n"
        };
        text += &point(first, usual);
        text += &self.limits();
        if !self.holds {
            text += &self.failing();
        }
        for (number, found) in (1..).zip(next) {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "\nnext {number}");
            text += &point(found, usual);
        }
        text
    }

    fn limits(&self) -> String {
        let mut text = format!(
            "  {:<22} {:>12} {:>12} {:>9}  {:<16} {}\n",
            "limit", "bound", "reached", "left", "of", "cheapest looked at without it"
        );
        let cost = self.found.first().map_or(0.0, |found| found.reached.cost());
        for standing in &self.standings {
            let Standing {
                limit,
                value,
                slack,
                cost_without,
                ..
            } = standing;
            let without = match cost_without {
                Some(without) if self.holds && *without < cost => {
                    format!("{without:.0} ({})", per_cent(without / cost - 1.0))
                }
                Some(_) if self.holds => "as cheap: does not bind".to_owned(),
                Some(without) => format!("{without:.0}"),
                None => "none".to_owned(),
            };
            let _ = writeln!(
                text,
                "  {:<22} {:>12} {:>12} {:>9}  {:<16} {without}",
                limit.quantity.name(),
                limit.quantity.show(limit.bound),
                limit.quantity.show(*value),
                per_cent(*slack),
                limit.of,
            );
        }
        text
    }

    /// Which limit would have to give way, by how much.
    fn failing(&self) -> String {
        let mut alone: Vec<(&Standing, f64)> = self
            .standings
            .iter()
            .filter_map(|standing| Some((standing, standing.missed_alone?)))
            .filter(|(_, missed)| *missed > 0.0)
            .collect();
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
            let _ = writeln!(
                text,
                "  {} ({}) in its place: missed by {}",
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

/// A point in a few lines.
fn point(found: &Found, usual: &Config) -> String {
    let Found {
        design,
        machine,
        reached,
    } = found;
    let widths: Vec<String> = design
        .widths
        .iter()
        .map(|(name, bits)| format!("{name} {bits}"))
        .collect();
    let fields: Vec<String> = SETTINGS
        .iter()
        .filter(|setting| setting.value(machine) != setting.value(usual))
        .map(|setting| format!("{} {}", setting.key, setting.show(machine)))
        .collect();
    let [geometry, sort, raster] = reached.phases;
    let all = reached.area.raster + reached.area.around;
    let error = reached.error.map_or(String::new(), |error| {
        format!(
            "; largest error {:.3e}, PSNR {:.2} dB",
            error.max_abs,
            error.psnr_db()
        )
    });
    let pace = &reached.pace;
    let spread = &reached.ms_per_frame;
    let energy = reached.millijoules;
    format!(
        "  cost      {:.0} in look-up tables: {all}\n  \
           pace      {:.2} frames a second at {} MHz{}, {:.3} ms a frame (95 %: {:.3}, mean {:.3}), limited by {}{error}; {energy:.3} mJ a frame (estimate)\n  \
           cycles    geometry {geometry}, sort {sort}, raster {raster}; {:.2} MB a frame, {:.0} MB a second\n  \
           design    {} ({}, {})\n  \
           machine   {}\n",
        reached.cost(),
        pace.frames_per_s,
        pace.clock.mhz,
        if pace.clock.assumed { " (assumed)" } else { "" },
        spread.worst,
        spread.percentile_95,
        spread.mean,
        pace.limited_by,
        pace.bytes_per_frame as f64 / 1e6,
        pace.bytes_per_s / 1e6,
        widths.join(", "),
        design.rounding,
        design.traversal,
        if fields.is_empty() {
            "all as by default".to_owned()
        } else {
            fields.join(", ")
        },
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

//! Workload statistics of a picture: what an RTL designer schedules from.
//!
//! All are counted over the rows that the machine draws: splats a tile and pairs a splat, layers until a pixel stops to
//! blend, pairs until a tile has finished, how much of each splat still meets open pixels, the bits in which sort keys
//! differ, and what a frame has in common with the one before.

use crate::machine::config::Config;
use crate::machine::histogram::{Histogram, Histograms};
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::workload::Workload;
use crate::report::chart::{Anchor, Chart, TEXT, text_width};
use crate::report::html::escape;
use crate::report::labels::Rectangle;
use crate::report::shell::Shell;
use crate::report::table::count;
use serde::Serialize;
use std::collections::HashSet;

/// Classes of what is left of a splat: nothing, up to a tenth, ..., all of it.
const TENTHS: usize = 12;

/// Statistics of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statistics {
    /// Of tiles and splats.
    pub histograms: Histograms,
    /// Layers that a pixel blends until it has finished or its list ends.
    pub layers_per_pixel: Histogram,
    /// Pairs after which a tile has finished, of those that do.
    pub pairs_until_finished: Histogram,
    /// Tiles that finish, and all of them.
    pub finished_tiles: [u64; 2],
    /// Visible splats by which part of the pixels that they cover is still open: none, up to a tenth, ..., all.
    pub open_part_per_splat: [u64; TENTHS],
    /// Sort keys differ in these bits.
    pub key_bits: u64,
    /// Beside the frame before, if there is one of the same size.
    pub reuse: Option<FrameReuse>,
}

/// What two frames have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct FrameReuse {
    /// Splats that are seen in both, and in the second.
    pub splats: [u64; 2],
    /// Pairs of a splat and a tile of both, and of the second.
    pub pairs: [u64; 2],
}

impl Statistics {
    /// Of a frame on a machine; `before` is the frame before it.
    pub fn new(workload: &Workload, machine: &Config, before: Option<&Workload>) -> Statistics {
        let work = LaneWork::new(workload, LaneShape::from(machine));
        let (layers, splats) = counted(workload);
        let mut open_part_per_splat = [0; TENTHS];
        for [open, covered] in splats.iter().filter(|splat| splat[1] > 0) {
            let class = match *open {
                0 => 0,
                open if open == *covered => TENTHS - 1,
                open => 1 + (10 * open / covered) as usize,
            };
            open_part_per_splat[class] += 1;
        }
        let finished = workload
            .tiles
            .iter()
            .filter(|tile| tile.finished_after != u32::MAX);
        Statistics {
            histograms: Histograms::new(&work, machine, workload.splats.len()),
            layers_per_pixel: Histogram::of(layers),
            finished_tiles: [finished.clone().count() as u64, workload.tiles.len() as u64],
            pairs_until_finished: Histogram::of(finished.map(|tile| tile.finished_after.into())),
            open_part_per_splat,
            key_bits: workload.key_bits,
            reuse: before.and_then(|before| FrameReuse::of(before, workload)),
        }
    }
}

/// Layers of every pixel, and open and all covered pixels of every splat; counted once per pair, tile by tile.
fn counted(workload: &Workload) -> (Vec<u64>, Vec<[u64; 2]>) {
    let [width, height] = workload.tile.map(usize::from);
    let mut all = Vec::new();
    let mut splats = vec![[0; 2]; workload.splats.len()];
    for (number, tile) in workload.tiles.iter().enumerate() {
        let mut layers = vec![0u64; width * height];
        for index in workload.pairs_in(number) {
            let pair = &workload.pairs[index];
            for (y, one) in (usize::from(pair.first_row)..).zip(workload.rows_of(index)) {
                let mut open = one.covered & one.open;
                while open != 0 {
                    layers[y * width + open.trailing_zeros() as usize] += 1;
                    open &= open - 1;
                }
                if let Some([open, covered]) = splats.get_mut(pair.splat as usize) {
                    *open += u64::from((one.covered & one.open).count_ones());
                    *covered += u64::from(one.covered.count_ones());
                }
            }
        }
        // Pixels beyond the screen are covered by nothing: those with no layer are as many too many.
        let beyond = layers.len().saturating_sub(tile.pixels as usize);
        let mut empty = 0;
        layers.retain(|count| {
            empty += usize::from(*count == 0);
            *count > 0 || empty > beyond
        });
        all.extend(layers);
    }
    (all, splats)
}

impl FrameReuse {
    /// Nothing where the tiles are others.
    fn of(before: &Workload, now: &Workload) -> Option<FrameReuse> {
        let same = before.tile == now.tile
            && before.tiles.len() == now.tiles.len()
            && before.splats.len() == now.splats.len();
        if !same {
            return None;
        }
        let mut pairs = [0; 2];
        for tile in 0..now.tiles.len() {
            let known = before.pairs_of(tile).iter().map(|pair| pair.splat);
            let known: HashSet<u32> = known.collect();
            let list = now.pairs_of(tile);
            let stayed = list.iter().filter(|pair| known.contains(&pair.splat));
            pairs[0] += stayed.count() as u64;
            pairs[1] += list.len() as u64;
        }
        let both = before.splats.iter().zip(&now.splats);
        let both = both.filter(|(before, now)| before.tiles > 0 && now.tiles > 0);
        Some(FrameReuse {
            splats: [both.count() as u64, now.visible() as u64],
            pairs,
        })
    }
}

/// The page of one or several frames.
pub fn page(title: &str, frames: &[(&str, &Statistics)]) -> String {
    let mut body = String::new();
    for (name, statistics) in frames {
        body += &format!("<section>\n<h2>{}</h2>\n", escape(name));
        body += &in_words(statistics);
        body += "<div class=\"charts\">\n";
        let of = &statistics.histograms;
        for (what, histogram) in [
            ("pairs a tile", &of.pairs_per_tile),
            ("tiles a splat", &of.tiles_per_splat),
            ("pixels a splat covers", &of.covered_per_splat),
            ("lane cycles a tile", &of.lane_cycles_per_tile),
            ("layers a pixel blends", &statistics.layers_per_pixel),
            (
                "pairs until a tile has finished",
                &statistics.pairs_until_finished,
            ),
        ] {
            // Of no members there is nothing to show; the words say so.
            if !histogram.classes.is_empty() {
                body += &chart_of(what, histogram);
            }
        }
        body += &open_chart(&statistics.open_part_per_splat);
        body += "</div>\n</section>\n";
    }
    let facts =
        "<p class=\"facts\">Classes double from bar to bar. Point at a bar for its number.</p>\n";
    Shell::still("splatline: workload", title, facts, &body).html()
}

/// What the charts do not show.
fn in_words(statistics: &Statistics) -> String {
    let [finished, tiles] = statistics.finished_tiles;
    let keys = statistics.key_bits;
    let mut words = format!(
        "{} of {} tiles finish before their lists end. Sort keys differ in {} bits, of which the highest is bit {}: a radix sort by digits of 8 bits \
         needs {} passes.",
        count(finished),
        count(tiles),
        keys.count_ones(),
        63u32.saturating_sub(keys.leading_zeros()),
        (0..8)
            .filter(|digit| (keys >> (8 * digit)) & 0xff != 0)
            .count()
    );
    if let Some(FrameReuse { splats, pairs }) = &statistics.reuse {
        let per_cent = |[both, all]: &[u64; 2]| 100.0 * *both as f64 / (*all).max(1) as f64;
        words += &format!(
            " Of the frame before, {:.1} % of the splats and {:.1} % of the pairs of a splat and a tile are still there.",
            per_cent(splats),
            per_cent(pairs)
        );
    }
    format!("<p class=\"read\">{words}</p>\n")
}

fn chart_of(what: &str, histogram: &Histogram) -> String {
    let members: u64 = histogram.classes.iter().sum();
    let mean = histogram.sum as f64 / members.max(1) as f64;
    let first = |class: usize| class.checked_sub(1).map_or(0, |power| 1u64 << power);
    let names = (0..).map(|class| first(class).to_string());
    let bars: Vec<_> = names.zip(histogram.classes.iter().copied()).collect();
    let largest = count(histogram.largest);
    let heading = format!("{what}: mean {mean:.1}, at most {largest}");
    bars_of(&heading, "from", &bars)
}

fn open_chart(classes: &[u64; TENTHS]) -> String {
    let name = |class: usize| match class {
        class if class == TENTHS - 1 => "all".to_owned(),
        class => format!("{}", 10 * class),
    };
    let bars: Vec<(String, u64)> = (0..).map(name).zip(*classes).collect();
    let heading = "part of a splat's pixels that is still open, up to so many per cent";
    bars_of(heading, "up to", &bars)
}

/// How wide a name is at most: the page's style writes them larger than other charts' (`.charts .chart text`, 19 pixels
/// on a narrow screen).
fn name_width(name: &str) -> f64 {
    text_width(name) * 19.0 / TEXT
}

/// Bars beside each other, with their names below.
fn bars_of(heading: &str, class: &str, bars: &[(String, u64)]) -> String {
    let (width, height, left) = (430.0, 150.0, 8.0);
    let most = bars.iter().map(|(_, members)| *members).max();
    let most = most.unwrap_or(0).max(1);
    let step = (width - 2.0 * left) / bars.len().max(1) as f64;
    let mut chart = Chart::new(width, height + 44.0, heading);
    // Every bar is named, or every second, or third: names do not touch.
    let widths: Vec<f64> = bars.iter().map(|(name, _)| name_width(name)).collect();
    let apart = |every: &usize| {
        let named: Vec<&f64> = widths.iter().step_by(*every).collect();
        (named.windows(2)).all(|pair| (pair[0] + pair[1]) / 2.0 <= step * *every as f64)
    };
    let every = (1..=bars.len()).find(apart).unwrap_or(1);
    for (place, (name, members)) in bars.iter().enumerate() {
        let tall = height * *members as f64 / most as f64;
        let corner = [left + step * place as f64 + 1.0, 10.0 + height - tall];
        let bar = Rectangle::new(corner, [(step - 2.0).max(1.0), tall]);
        let words = format!("{class} {name}: {}", count(*members));
        chart.bar(&bar, "fill=\"#2f6fde\"", &words);
        if place % every == 0 {
            let middle = left + step * (place as f64 + 0.5);
            chart.text((middle, height + 26.0), Anchor::Middle, "", name);
        }
    }
    format!(
        "<figure><figcaption>{}</figcaption>{}</figure>\n",
        escape(heading),
        chart.finish()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DesignChoice;
    use crate::plan::Prepared;
    use crate::scene::synthetic;

    fn workloads(zooms: [f64; 2]) -> [Workload; 2] {
        let scene = synthetic::random_gaussians(300, 2, 3.0);
        let (camera, rules) = (synthetic::camera(50, 41), scene.natural_rules);
        let design = DesignChoice::named("standard24").unwrap();
        let prepared = Prepared::of_splats(scene, camera.clone(), rules, design);
        let seen = |zoom| prepared.seen_by(camera.zoomed(zoom).unwrap());
        zooms.map(|zoom| seen(zoom).workload().unwrap())
    }

    /// Every count is of all pixels, tiles, splats or blended pixels of the picture.
    #[test]
    fn counts_add_up_to_the_workload() {
        let [before, now] = workloads([1.0, 1.1]);
        let statistics = Statistics::new(&now, &Config::default(), Some(&before));
        let members = |histogram: &Histogram| histogram.classes.iter().sum::<u64>();
        assert_eq!(members(&statistics.layers_per_pixel), 50 * 41);
        assert_eq!(statistics.layers_per_pixel.sum, now.totals().live);
        let of = &statistics.histograms;
        assert_eq!(of.pairs_per_tile.sum, now.pairs.len() as u64);
        let finished = members(&statistics.pairs_until_finished);
        assert_eq!(finished, statistics.finished_tiles[0]);
        let covering = members(&of.covered_per_splat) - of.covered_per_splat.classes[0];
        assert_eq!(statistics.open_part_per_splat.iter().sum::<u64>(), covering);
        let reuse = statistics.reuse.unwrap();
        assert_eq!(reuse.pairs[1], now.pairs.len() as u64);
        assert!(reuse.pairs[0] > reuse.pairs[1] / 2 && reuse.pairs[0] < reuse.pairs[1]);
        // No tile of this frame finishes: a chart of nothing is not drawn.
        assert_eq!(statistics.finished_tiles[0], 0);
        let page = page("<random>", &[("a & b", &statistics)]);
        assert!(page.contains("&lt;random&gt;") && page.contains("a &amp; b"));
        assert_eq!(page.matches("<svg").count(), 6);
        assert!(page.contains("Of the frame before, ") && !page.contains("NaN"));
    }

    /// Names of a chart's bars do not touch, however many and long they are; what can be named is.
    #[test]
    fn names_of_bars_keep_apart() {
        let named = |count: u32, name: fn(u32) -> String| {
            let bars: Vec<(String, u64)> = (0..count).map(|bar| (name(bar), 1)).collect();
            let chart = bars_of("bars", "from", &bars);
            let texts: Vec<(f64, f64)> = (chart.split("<text").skip(1))
                .map(|text| {
                    let (_, place) = text.split_once(" x=\"").unwrap();
                    let (_, name) = text.split_once('>').unwrap();
                    let (name, _) = name.split_once('<').unwrap();
                    (
                        place.split('"').next().unwrap().parse().unwrap(),
                        name_width(name),
                    )
                })
                .collect();
            for pair in texts.windows(2) {
                let apart = pair[1].0 - pair[0].0;
                assert!(apart + 0.1 >= (pair[0].1 + pair[1].1) / 2.0, "{pair:?}");
            }
            texts.len()
        };
        assert_eq!(named(9, |bar| (1 << bar).to_string()), 9);
        named(12, |bar| (1 << bar).to_string());
        named(40, |bar| (1u64 << bar).to_string());
        let open = open_chart(&[1; TENTHS]);
        assert_eq!(open.matches("<text").count(), TENTHS, "{open}");
    }

    #[test]
    fn a_frame_has_all_in_common_with_itself() {
        let [one, _] = workloads([1.0, 1.0]);
        let reuse = FrameReuse::of(&one, &one).unwrap();
        assert_eq!(reuse.pairs[0], reuse.pairs[1]);
        assert_eq!(reuse.splats[0], reuse.splats[1]);
    }
}

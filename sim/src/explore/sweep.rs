//! Runs the points of a space. Work that points share is done once: a picture per design, a workload per design and tile, lane
//! work per lane shape.

use super::folder::Appender;
use super::space::{Part, Space};
use super::table::Table;
use crate::design::DesignChoice;
use crate::fixed::{self, Options};
use crate::machine::area::{Area, Calibration, estimate};
use crate::machine::clock::{Clock, Pace};
use crate::machine::config::Config;
use crate::machine::energy::{self, EnergyTable};
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::workload::{Workload, extract_if_room};
use crate::machine::{Timing, simulate};
use crate::metrics::{ChannelError, compare};
use crate::picture::Picture;
use crate::plan::Splats;
use anyhow::{Context, Result, anyhow};
use rayon::prelude::*;
use splatline::format::Traversal;
use toml::Value;

/// What is swept over: everything that the points have in common.
pub struct Subject<'a> {
    /// The splats, from where and how they are drawn.
    pub splats: Splats<'a>,
    /// The design that points start from.
    pub design: DesignChoice,
    /// The traversal, unless the space or the design says otherwise.
    pub traversal: Option<Traversal>,
    /// The machine that points start from.
    pub machine: Config,
    /// Prices of area.
    pub calibration: Calibration,
    /// Energies of actions.
    pub energy: EnergyTable,
    /// The float reference's picture; none leaves errors out.
    pub reference: Option<&'a Picture>,
}

/// Part `index` (from 1) of `count`: every `count`-th group of points that share their picture's tile lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub index: usize,
    /// Number of shards.
    pub count: usize,
}

impl Shard {
    /// Whether a point belongs to this shard: contiguous blocks, so that shared work stays together.
    pub fn holds(&self, point: usize, points: usize) -> bool {
        point * self.count / points.max(1) + 1 == self.index
    }
}

/// A point's number and its place in the space.
type Point<'a> = (usize, &'a [usize]);

/// Runs all points of the shard that `done` does not hold yet. `progress` is told of every finished point.
pub fn run(
    subject: &Subject,
    space: &Space,
    shard: Shard,
    done: &Table,
    out: &Appender,
    progress: &(dyn Fn() + Sync),
) -> Result<()> {
    let (all, splats) = (space.points.len(), &subject.splats);
    let open: Vec<Point> = (0..)
        .zip(&space.points)
        .filter(|(number, _)| shard.holds(*number, all) && !done.lines.contains_key(number))
        .map(|(number, point)| (number, point.as_slice()))
        .collect();
    for group in open.chunk_by(|a, b| same(space, a.1, b.1, Part::Design)) {
        let design = design_of(subject, space, group[0].1)?;
        let options = Options {
            rules: splats.rules,
            compositing: splats.compositing,
            design: &design,
            traversal: traversal_of(subject, space, group[0].1, &design),
        };
        let error = match subject.reference {
            Some(reference) => {
                let drawing = fixed::draw(splats.scene, splats.camera, &options);
                Some(
                    compare(&drawing.picture, reference)
                        .context("the pictures cannot be compared")?
                        .colour,
                )
            }
            None => None,
        };
        for tiles in group.chunk_by(|a, b| same(space, a.1, b.1, Part::Tile)) {
            let tile = tile_of(subject, space, tiles[0].1)?;
            let workload = extract_if_room(splats.scene, splats.camera, &options, tile)?;
            let run = Run {
                subject,
                space,
                options: &options,
                error: error.as_ref(),
                workload: &workload,
                out,
                progress,
            };
            let shapes: Vec<&[Point]> = tiles
                .chunk_by(|a, b| same(space, a.1, b.1, Part::Lanes))
                .collect();
            shapes
                .into_par_iter()
                .try_for_each(|points| run.points(points))?;
        }
    }
    Ok(())
}

/// Do two points agree on all axes up to this part?
fn same(space: &Space, a: &[usize], b: &[usize], part: Part) -> bool {
    space
        .axes
        .iter()
        .zip(a.iter().zip(b))
        .all(|(axis, (a, b))| axis.part > part || a == b)
}

fn design_of(subject: &Subject, space: &Space, point: &[usize]) -> Result<DesignChoice> {
    let settings = space.settings(point, |part| part == Part::Design);
    changed(&subject.design, &settings)
}

/// A design with some of its keys set otherwise; `base` names another one to begin with, or its file.
pub(super) fn changed(start: &DesignChoice, settings: &[(&str, &Value)]) -> Result<DesignChoice> {
    if settings.is_empty() {
        return Ok(start.clone());
    }
    let base = settings
        .iter()
        .find(|(key, _)| *key == "base")
        .and_then(|(_, value)| value.as_str());
    let start = match base {
        Some(name) => DesignChoice::load(name)?,
        None => start.clone(),
    };
    let mut table: toml::Table = start.resolved().to_toml().parse()?;
    for (key, value) in settings.iter().filter(|(key, _)| *key != "base") {
        table.insert((*key).to_owned(), (*value).clone());
    }
    Ok(DesignChoice::from_toml("space.toml", &table.to_string())?)
}

fn traversal_of(
    subject: &Subject,
    space: &Space,
    point: &[usize],
    design: &DesignChoice,
) -> Traversal {
    let swept = !space
        .settings(point, |part| part == Part::Design)
        .iter()
        .all(|(key, _)| *key != "traversal");
    if swept {
        design.traversal
    } else {
        subject.traversal.unwrap_or(design.traversal)
    }
}

fn machine_of(subject: &Subject, space: &Space, point: &[usize]) -> Result<Config> {
    let mut config = subject.machine;
    for (key, value) in space.settings(point, |part| part != Part::Design) {
        config.set("space", key, value)?;
    }
    Ok(config)
}

fn tile_of(subject: &Subject, space: &Space, point: &[usize]) -> Result<[u16; 2]> {
    let config = machine_of(subject, space, point)?;
    Ok([config.tile_width, config.tile_height])
}

/// Points with the same workload.
struct Run<'a> {
    subject: &'a Subject<'a>,
    space: &'a Space,
    options: &'a Options<'a>,
    error: Option<&'a ChannelError>,
    workload: &'a Workload,
    out: &'a Appender,
    progress: &'a (dyn Fn() + Sync),
}

impl Run<'_> {
    /// Points with the same lane shape.
    fn points(&self, points: &[Point]) -> Result<()> {
        let first = machine_of(self.subject, self.space, points[0].1)?;
        // A shape that makes no machine is not even grouped; its points say why.
        let work = match first.check_together() {
            Ok(()) => LaneWork::new(self.workload, LaneShape::from(&first)),
            Err(_) => LaneWork::default(),
        };
        points
            .par_iter()
            .try_for_each(|point| self.point(&work, *point))
    }

    fn point(&self, work: &LaneWork, (number, point): Point) -> Result<()> {
        let config = machine_of(self.subject, self.space, point)?;
        let results = match config.check_together() {
            Ok(()) => {
                let timing = simulate(self.workload, work, &config);
                let area = estimate(
                    &self.options.design.widths,
                    self.options.traversal,
                    &config,
                    &self.subject.calibration,
                );
                let widths = &self.options.design.widths;
                let energy = energy::estimate(
                    widths,
                    self.options.traversal,
                    &config,
                    &timing,
                    &self.subject.energy,
                );
                let clock = Clock::of(&config, widths, self.subject.calibration.family);
                let pace = Pace::new(&timing, &config, clock);
                results(self.error, &timing, &pace, &area, energy.mj_per_frame)
            }
            Err((key, value, allowed)) => left_out(&format!("{key} = {value}: {allowed}")),
        };
        let axes = self.space.texts(point);
        let fields: Vec<String> = std::iter::once(number.to_string())
            .chain(axes)
            .chain(results)
            .collect();
        self.out
            .append(&fields.join(","))
            .map_err(|error| anyhow!("cannot append to the table: {error}"))?;
        (self.progress)();
        Ok(())
    }
}

/// The result columns in the order of [`super::table::RESULTS`].
fn results(
    error: Option<&ChannelError>,
    timing: &Timing,
    pace: &Pace,
    area: &Area,
    energy_mj: f64,
) -> Vec<String> {
    let mut fields = match error {
        Some(error) => {
            let psnr = if error.psnr_db.is_finite() {
                format!("{:.3}", error.psnr_db)
            } else {
                String::new()
            };
            let mut fields = vec![psnr];
            fields.extend(
                [error.rms(), error.max_abs, error.bias].map(|value| format!("{value:.4e}")),
            );
            fields.push(format!("{:.6}", error.ssim));
            fields
        }
        None => vec![String::new(); 5],
    };
    fields.extend(
        [timing.total, timing.geometry, timing.sort, timing.raster]
            .map(|cycles| cycles.to_string()),
    );
    let busy = timing
        .units
        .get("lanes")
        .map_or(0.0, |unit| unit.utilisation);
    fields.extend(
        [
            busy,
            timing.pixels.covered_per_cycle_and_lane,
            timing.pixels.live_per_cycle_and_lane,
        ]
        .map(|part| format!("{part:.4}")),
    );
    fields.extend([
        pace.clock.mhz.to_string(),
        u8::from(pace.clock.assumed).to_string(),
        format!("{:.3}", pace.frames_per_s),
        format!("{:.4}", pace.ms_per_frame),
        pace.bytes_per_frame.to_string(),
        format!("{:.0}", pace.bytes_per_s),
        format!("{:.4}", timing.pixels.packet_hit_rate()),
    ]);
    for part in [&area.raster, &area.around] {
        fields.extend(part.resources().map(|(_, count)| count.to_string()));
    }
    fields.push(format!("{:.0}", area.weight));
    fields.push(format!("{energy_mj:.5}"));
    fields.push(String::new());
    fields
}

fn left_out(reason: &str) -> Vec<String> {
    let mut fields = vec![String::new(); super::table::RESULTS.len() - 1];
    fields.push(reason.replace([',', '\n', '"'], " "));
    fields
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::explore::table::heading;
    use crate::reference::float;
    use crate::rules::Compositing;
    use crate::scene::synthetic;

    const SPACE: &str = "[design]\nbase = [\"lean18\", \"standard24\"]\n[machine]\ntile_width = [8, 16]\nlanes = [1, 4]\n\
                         layout = [\"run\", \"quad\"]\nrow_cycles = [1, 3]\n";

    fn sweep(shard: Shard, done: &Table, path: &std::path::Path) {
        let scene = synthetic::random_gaussians(300, 1, 2.0);
        let camera = synthetic::camera(48, 32);
        let space = Space::from_toml("s.toml", SPACE).unwrap();
        let reference = float::draw(
            &scene,
            &camera,
            &scene.natural_rules,
            Compositing::FrontToBack,
        )
        .picture;
        let subject = Subject {
            splats: Splats {
                scene: &scene,
                camera: &camera,
                rules: &scene.natural_rules,
                compositing: Compositing::FrontToBack,
                hybrid: None,
            },
            design: DesignChoice::named("standard24").unwrap(),
            traversal: None,
            machine: Config::default(),
            calibration: Calibration::default(),
            energy: EnergyTable::default(),
            reference: Some(&reference),
        };
        let (out, _) = Appender::open(path, &heading(&space)).unwrap();
        run(&subject, &space, shard, done, &out, &|| ()).unwrap();
    }

    #[test]
    fn shards_and_resumed_sweeps_give_the_whole_sweep() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let read =
            |name: &str| Table::from_csv(&std::fs::read_to_string(path(name)).unwrap()).unwrap();
        let whole = Shard { index: 1, count: 1 };
        sweep(whole, &Table::default(), &path("whole.csv"));
        let complete = read("whole.csv");
        assert_eq!(complete.lines.len(), 32);
        let left_out = complete
            .lines
            .values()
            .filter(|line| line.contains("allowed with 2 or more lanes"))
            .count();
        assert_eq!(left_out, 8, "quads of one lane");

        let mut merged = Table {
            heading: complete.heading.clone(),
            ..Table::default()
        };
        for index in 1..=3 {
            let name = format!("{index}.csv");
            sweep(Shard { index, count: 3 }, &Table::default(), &path(&name));
            merged.merge(read(&name)).unwrap();
        }
        assert_eq!(merged, complete);

        let text = std::fs::read_to_string(path("whole.csv")).unwrap();
        std::fs::write(path("cut.csv"), &text[..text.len() / 2]).unwrap();
        sweep(whole, &read("cut.csv"), &path("cut.csv"));
        assert_eq!(read("cut.csv"), complete);
    }
}

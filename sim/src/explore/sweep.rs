//! Runs the points of a space. Work that points share is done once: a picture per design, a workload per design and tile, lane
//! work per lane shape. Of several frames one after the other is walked, so that the rows of one alone lie in memory; a point's line has its slowest
//! frame, and the spread of its time over all.

use super::folder::Appender;
use super::space::{Space, SpacePart};
use super::table::ResultTable;
use crate::design::DesignChoice;
use crate::fixed::{self, Options};
use crate::machine::area::{Area, Calibration, estimate};
use crate::machine::clock::{Clock, Throughput};
use crate::machine::config::Config;
use crate::machine::energy::{self, EnergyTable};
use crate::machine::lanes::{LaneShape, LaneWork};
use crate::machine::summary::Spread;
use crate::machine::workload::{Workload, extract_if_room};
use crate::machine::{Timing, simulate};
use crate::metrics::{ChannelError, compare};
use crate::picture::Picture;
use crate::plan::Splats;
use anyhow::{Context, Result, anyhow};
use rayon::prelude::*;
use splatline::format::Traversal;
use std::sync::{Mutex, MutexGuard};
use toml::Value;

/// What is swept over: everything that the points have in common.
pub struct SweepSubject<'a> {
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
    /// Further frames, each with its reference's picture: of other scenes, or along a camera path.
    pub more: Vec<(Splats<'a>, Option<&'a Picture>)>,
}

impl<'a> SweepSubject<'a> {
    /// All frames.
    fn frames(&self) -> Vec<(&Splats<'a>, Option<&'a Picture>)> {
        let more = self.more.iter().map(|(splats, picture)| (splats, *picture));
        std::iter::once((&self.splats, self.reference))
            .chain(more)
            .collect()
    }
}

/// Errors of a design over all frames.
struct SweepError {
    psnr_db: f64,
    rms: f64,
    max_abs: f64,
    bias: f64,
    ssim: f64,
}

impl SweepError {
    /// Root of the mean square, the largest, and the means of bias and structural similarity.
    fn over(all: &[ChannelError]) -> SweepError {
        let count = all.len().max(1) as f64;
        let mean = |of: &dyn Fn(&ChannelError) -> f64| all.iter().map(of).sum::<f64>() / count;
        let rms = mean(&|error| error.rms() * error.rms()).sqrt();
        let (psnr_db, rms) = match all {
            [one] => (one.psnr_db, one.rms()),
            _ => (-20.0 * rms.log10(), rms),
        };
        SweepError {
            psnr_db,
            rms,
            max_abs: all.iter().map(|error| error.max_abs).fold(0.0, f64::max),
            bias: mean(&|error| error.bias),
            ssim: mean(&|error| error.ssim),
        }
    }
}

/// What a point takes on a frame.
struct OnFrame {
    timing: Timing,
    pace: Throughput,
    energy_mj: f64,
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
type SweepPoint<'a> = (usize, &'a [usize]);

/// Runs all points of the shard that `done` does not hold yet. `progress` is told of every finished point.
pub fn run(
    subject: &SweepSubject,
    space: &Space,
    shard: Shard,
    done: &ResultTable,
    out: &Appender,
    progress: &(dyn Fn() + Sync),
) -> Result<()> {
    let (all, frames) = (space.points.len(), subject.frames());
    let open: Vec<SweepPoint> = (0..)
        .zip(&space.points)
        .filter(|(number, _)| shard.holds(*number, all) && !done.lines.contains_key(number))
        .map(|(number, point)| (number, point.as_slice()))
        .collect();
    for group in open.chunk_by(|a, b| same(space, a.1, b.1, SpacePart::Design)) {
        let design = design_of(subject, space, group[0].1)?;
        let traversal = traversal_of(subject, space, group[0].1, &design);
        let error = errors(&frames, &design, traversal)?;
        for tiles in group.chunk_by(|a, b| same(space, a.1, b.1, SpacePart::Tile)) {
            let tile = tile_of(subject, space, tiles[0].1)?;
            let earlier: Vec<Mutex<Vec<OnFrame>>> =
                tiles.iter().map(|_| Mutex::default()).collect();
            for (place, (splats, _)) in frames.iter().enumerate() {
                let options = options(splats, &design, traversal);
                let workload = extract_if_room(splats.scene, splats.camera, &options, tile)?;
                let run = SharedWorkload {
                    subject,
                    space,
                    options: &options,
                    error: error.as_ref(),
                    workload: &workload,
                    tiles,
                    earlier: &earlier,
                    is_last: place + 1 == frames.len(),
                    out,
                    progress,
                };
                let shapes: Vec<&[SweepPoint]> = tiles
                    .chunk_by(|a, b| same(space, a.1, b.1, SpacePart::Lanes))
                    .collect();
                shapes
                    .into_par_iter()
                    .try_for_each(|points| run.points(points))?;
            }
        }
    }
    Ok(())
}

/// A design's errors over all frames; nothing where there are no references.
fn errors(
    frames: &[(&Splats, Option<&Picture>)],
    design: &DesignChoice,
    traversal: Traversal,
) -> Result<Option<SweepError>> {
    let mut all = Vec::with_capacity(frames.len());
    for (splats, reference) in frames {
        let Some(reference) = reference else {
            return Ok(None);
        };
        let drawing = fixed::draw(
            splats.scene,
            splats.camera,
            &options(splats, design, traversal),
        );
        let errors = compare(&drawing.picture, reference);
        all.push(errors.context("the pictures cannot be compared")?.colour);
    }
    Ok(Some(SweepError::over(&all)))
}

/// Do two points agree on all axes up to this part?
fn same(space: &Space, a: &[usize], b: &[usize], part: SpacePart) -> bool {
    space
        .axes
        .iter()
        .zip(a.iter().zip(b))
        .all(|(axis, (a, b))| axis.part > part || a == b)
}

fn design_of(subject: &SweepSubject, space: &Space, point: &[usize]) -> Result<DesignChoice> {
    let settings = space.settings(point, |part| part == SpacePart::Design);
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
    subject: &SweepSubject,
    space: &Space,
    point: &[usize],
    design: &DesignChoice,
) -> Traversal {
    let swept = !space
        .settings(point, |part| part == SpacePart::Design)
        .iter()
        .all(|(key, _)| *key != "traversal");
    if swept {
        design.traversal
    } else {
        subject.traversal.unwrap_or(design.traversal)
    }
}

/// How a frame is drawn by a design.
fn options<'a>(splats: &Splats<'a>, design: &'a DesignChoice, traversal: Traversal) -> Options<'a> {
    Options {
        rules: splats.rules,
        compositing: splats.compositing,
        design,
        traversal,
    }
}

fn machine_of(subject: &SweepSubject, space: &Space, point: &[usize]) -> Result<Config> {
    let mut config = subject.machine;
    for (key, value) in space.settings(point, |part| part != SpacePart::Design) {
        config.set("space", key, value)?;
    }
    Ok(config)
}

fn tile_of(subject: &SweepSubject, space: &Space, point: &[usize]) -> Result<[u16; 2]> {
    let config = machine_of(subject, space, point)?;
    Ok([config.tile_width, config.tile_height])
}

/// Points with the same workload.
struct SharedWorkload<'a> {
    subject: &'a SweepSubject<'a>,
    space: &'a Space,
    options: &'a Options<'a>,
    error: Option<&'a SweepError>,
    workload: &'a Workload,
    /// All points of the tile, and what each took on the frames before.
    tiles: &'a [SweepPoint<'a>],
    earlier: &'a [Mutex<Vec<OnFrame>>],
    is_last: bool,
    out: &'a Appender,
    progress: &'a (dyn Fn() + Sync),
}

impl SharedWorkload<'_> {
    /// Points with the same lane shape.
    fn points(&self, points: &[SweepPoint]) -> Result<()> {
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

    fn point(&self, work: &LaneWork, (number, point): SweepPoint) -> Result<()> {
        let config = machine_of(self.subject, self.space, point)?;
        let checked = config.check_together();
        if checked.is_ok() {
            let frame = self.on_frame(work, &config);
            self.frames_of(number).push(frame);
        }
        if !self.is_last {
            return Ok(());
        }
        let results = match checked {
            Ok(()) => self.results(number, &config),
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

    fn on_frame(&self, work: &LaneWork, config: &Config) -> OnFrame {
        let (widths, subject) = (&self.options.design.widths, self.subject);
        let timing = simulate(self.workload, work, config);
        let traversal = self.options.traversal;
        let energy = energy::estimate(widths, traversal, config, &timing, &subject.energy);
        let clock = Clock::of(config, widths, subject.calibration.family);
        OnFrame {
            pace: Throughput::new(&timing, config, clock),
            timing,
            energy_mj: energy.mj_per_frame,
        }
    }

    /// What the point of this number took on the frames before.
    fn frames_of(&self, number: usize) -> MutexGuard<'_, Vec<OnFrame>> {
        let place = self.tiles.partition_point(|(other, _)| *other < number);
        let frames = self.earlier[place].lock();
        frames.unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// A point's columns over all frames.
    fn results(&self, number: usize, config: &Config) -> Vec<String> {
        let frames = std::mem::take(&mut *self.frames_of(number));
        let (widths, prices) = (&self.options.design.widths, &self.subject.calibration);
        let area = estimate(widths, self.options.traversal, config, prices);
        results(self.error, &frames, &area)
    }
}

/// The result columns in the order of [`super::table::RESULTS`].
fn results(error: Option<&SweepError>, frames: &[OnFrame], area: &Area) -> Vec<String> {
    let slowest = frames
        .iter()
        .max_by(|a, b| a.pace.ms_per_frame.total_cmp(&b.pace.ms_per_frame));
    let Some(OnFrame { timing, pace, .. }) = slowest else {
        return left_out("no frame was simulated");
    };
    let energy_mj = frames.iter().map(|one| one.energy_mj).fold(0.0, f64::max);
    let spread = Spread::of(frames.iter().map(|one| one.pace.ms_per_frame));
    let mut fields = match error {
        Some(error) => {
            let psnr = if error.psnr_db.is_finite() {
                format!("{:.3}", error.psnr_db)
            } else {
                String::new()
            };
            let mut fields = vec![psnr];
            fields
                .extend([error.rms, error.max_abs, error.bias].map(|value| format!("{value:.4e}")));
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
        format!("{:.4}", spread.percentile_95),
        format!("{:.4}", spread.mean),
        frames.len().to_string(),
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

    fn sweep(shard: Shard, done: &ResultTable, path: &std::path::Path) {
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
        let subject = SweepSubject {
            splats: Splats {
                scene: &scene,
                camera: &camera,
                rules: &scene.natural_rules,
                compositing: Compositing::FrontToBack,
                method: &crate::plan::SplatMethod::Composited,
            },
            design: DesignChoice::named("standard24").unwrap(),
            traversal: None,
            machine: Config::default(),
            calibration: Calibration::default(),
            energy: EnergyTable::default(),
            reference: Some(&reference),
            more: Vec::new(),
        };
        let (out, _) = Appender::open(path, &heading(&space)).unwrap();
        run(&subject, &space, shard, done, &out, &|| ()).unwrap();
    }

    #[test]
    fn shards_and_resumed_sweeps_give_the_whole_sweep() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let read = |name: &str| {
            ResultTable::from_csv(&std::fs::read_to_string(path(name)).unwrap()).unwrap()
        };
        let whole = Shard { index: 1, count: 1 };
        sweep(whole, &ResultTable::default(), &path("whole.csv"));
        let complete = read("whole.csv");
        assert_eq!(complete.lines.len(), 32);
        let left_out = complete
            .lines
            .values()
            .filter(|line| line.contains("allowed with 2 or more lanes"))
            .count();
        assert_eq!(left_out, 8, "quads of one lane");

        let mut merged = ResultTable {
            heading: complete.heading.clone(),
            ..ResultTable::default()
        };
        for index in 1..=3 {
            let name = format!("{index}.csv");
            sweep(
                Shard { index, count: 3 },
                &ResultTable::default(),
                &path(&name),
            );
            merged.merge(read(&name)).unwrap();
        }
        assert_eq!(merged, complete);

        let text = std::fs::read_to_string(path("whole.csv")).unwrap();
        std::fs::write(path("cut.csv"), &text[..text.len() / 2]).unwrap();
        sweep(whole, &read("cut.csv"), &path("cut.csv"));
        assert_eq!(read("cut.csv"), complete);
    }
}

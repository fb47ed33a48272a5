//! Which lane layout is best: a sweep by `explore` over layouts, lanes and the row generator, per scene.

use super::{COMMAND, HardwareScene};
use anyhow::Context;
use splatline_sim::cli::Failure;
use splatline_sim::cli::write;
use splatline_sim::design::DesignChoice;
use splatline_sim::explore::folder::Appender;
use splatline_sim::explore::front::{Candidate, candidates};
use splatline_sim::explore::space::Space;
use splatline_sim::explore::sweep::{self, Shard};
use splatline_sim::explore::table::{ResultTable, heading};
use splatline_sim::machine::Config;
use splatline_sim::machine::area::{Calibration, synthesis};
use splatline_sim::machine::energy::EnergyTable;
use splatline_sim::picture::Picture;
use splatline_sim::plan::Splats;
use splatline_sim::rules::Compositing;
use std::fmt::Write;
use std::path::Path;

/// The space, as `splatline sweep --space` would read it.
const SPACE: &str = "\
[machine]
lanes = [1, 2, 4, 8]
layout = [\"run\", \"aligned\", \"quad\", \"rows\"]
binning = [\"box\", \"exact\"]
rows_at_once = [1, 2, 4, 8]
row_fifo = [4, 16, 64]
";

pub fn write_all(subjects: &[HardwareScene], folder: &Path) -> Result<(), Failure> {
    let space = Space::from_toml("layouts.toml", SPACE)?;
    let note = synthesis::statement(&Calibration::default());
    let mut text = format!(
        "# The best lane layout\n\nPrinted by `{COMMAND} --only layouts`, which runs the sweep of layouts.toml ({} points) over each scene; `splatline sweep SCENE --space docs/results/layouts.toml -o DIR` runs it over any other and writes all points as a page to sort and filter. For every number of \
         lanes and layout: the point with the most covered pixels per cycle and lane (the machine otherwise is the default one), and the smallest \
         area that comes within 2 % of it. LUT, FF, DSP and memory are those of its raster unit ({note}).\n",
        space.points.len()
    );
    write(&folder.join("layouts.toml"), SPACE.as_bytes())?;
    for subject in subjects {
        let table = sweep_of(subject, &space, None)?;
        let all = candidates(&table);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "\n## {}\n\n| lanes | layout | covered, best | Mcycles | within 2 %: rows at once | row FIFO | binning | LUT | FF | DSP | kbit |\n|--:|---|--:|--:|--:|--:|---|--:|--:|--:|--:|",
            subject.name
        );
        for lanes in ["1", "2", "4", "8"] {
            for layout in ["run", "aligned", "quad", "rows"] {
                text.push_str(&line(&table, &all, lanes, layout));
            }
        }
    }
    write(&folder.join("layouts.md"), text.as_bytes())
}

/// All points of a space; with errors where there is a reference.
pub fn sweep_of(
    subject: &HardwareScene,
    space: &Space,
    reference: Option<&Picture>,
) -> Result<ResultTable, Failure> {
    let folder = std::env::temp_dir().join(format!("splatline-layouts-{}", std::process::id()));
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot create '{}'", folder.display()))?;
    let path = folder.join("points.csv");
    let (out, _) = Appender::open(&path, &heading(space))?;
    let task = sweep::SweepSubject {
        splats: Splats {
            scene: &subject.scene,
            camera: &subject.camera,
            rules: &subject.rules,
            compositing: Compositing::FrontToBack,
            hybrid: None,
        },
        design: DesignChoice::all().remove(2),
        traversal: None,
        energy: EnergyTable::default(),
        machine: Config::default(),
        calibration: Calibration::default(),
        reference,
        more: Vec::new(),
    };
    let done = sweep::run(
        &task,
        space,
        Shard { index: 1, count: 1 },
        &ResultTable::default(),
        &out,
        &|| (),
    );
    let text = std::fs::read_to_string(&path);
    std::fs::remove_dir_all(&folder)
        .with_context(|| format!("cannot remove '{}'", folder.display()))?;
    done?;
    Ok(ResultTable::from_csv(&text?).map_err(anyhow::Error::msg)?)
}

/// The best point of one shape, and the smallest one near it.
fn line(table: &ResultTable, all: &[Candidate], lanes: &str, layout: &str) -> String {
    let field = |candidate: &Candidate, name: &str| {
        let line = table.lines.get(&candidate.point)?;
        line.split(',').nth(table.column(name)?).map(str::to_owned)
    };
    let covered = |candidate: &Candidate| {
        field(candidate, "covered_per_cycle_and_lane")
            .and_then(|text| text.parse::<f64>().ok())
            .unwrap_or(0.0)
    };
    let is = |candidate: &&Candidate| {
        field(candidate, "lanes").as_deref() == Some(lanes)
            && field(candidate, "layout").as_deref() == Some(layout)
    };
    let Some(best) = all
        .iter()
        .filter(is)
        .max_by(|a, b| covered(a).total_cmp(&covered(b)))
    else {
        return String::new();
    };
    let near = all
        .iter()
        .filter(is)
        .filter(|candidate| covered(candidate) >= 0.98 * covered(best));
    let small = near
        .min_by(|a, b| a.area.total_cmp(&b.area))
        .unwrap_or(best);
    let show = |name: &str| field(small, name).unwrap_or_default();
    format!(
        "| {lanes} | {layout} | {:.3} | {:.3} | {} | {} | {} | {} | {} | {} | {} |\n",
        covered(best),
        best.cycles / 1e6,
        show("rows_at_once"),
        show("row_fifo"),
        show("binning"),
        show("raster_luts"),
        show("raster_flip_flops"),
        show("raster_dsps"),
        show("raster_memory_kbit")
    )
}

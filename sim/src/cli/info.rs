//! `splatline info`: what is in a scene, before anything is drawn.

use super::output::{self, Outputs};
use super::say::print_result;
use crate::framing::{Ball, FramingInput, direction};
use crate::plan::load::{AnyScene, recognise};
use crate::report::facts::{ReasonCounts, counted, named};
use crate::scene::points::SurfaceScene;
use crate::scene::{Scene, SortOrder, Weight};
use crate::vector::{self, Vector};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct InfoOptions {
    /// Scene, volume, point cloud or height field; - reads stdin
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// Transfer function of a volume (TOML)
    #[arg(long, value_name = "file.toml")]
    pub transfer: Option<PathBuf>,
    /// Write the answer as JSON instead; - is stdout
    #[arg(long, value_name = "i.json", help_heading = "Output")]
    pub json: Option<PathBuf>,
}

/// What is told.
#[derive(Default, Serialize)]
struct Info {
    format: &'static str,
    scene: String,
    kind: &'static str,
    count: usize,
    /// Of the centres.
    bounds: Option<[Vector; 2]>,
    ball: Ball,
    up: Vector,
    front: Vector,
    /// Smallest, median and largest of each.
    ranges: Vec<ShownRange>,
    harmonics_degree: u8,
    rules: &'static str,
    /// What its splats are sorted by.
    order: &'static str,
    /// Records left out, by reason.
    dropped: ReasonCounts,
    notes: Vec<String>,
}

#[derive(Serialize)]
struct ShownRange {
    of: &'static str,
    least: f64,
    median: f64,
    greatest: f64,
}

pub fn run(options: &InfoOptions) -> Result<()> {
    let outputs = Outputs::default().json(options.json.as_ref())?;
    let loaded = recognise(&options.scene, options.transfer.clone())?;
    outputs.spare_inputs()?;
    let info = match &loaded.scene {
        AnyScene::Splats(scene) => Info::of_scene(scene, loaded.notes),
        AnyScene::Surface {
            scene,
            is_height_field,
        } => Info::of_surface(scene, *is_height_field),
    };
    match &options.json {
        Some(path) => output::write_json(path, &info),
        None => print_result(&info.text()),
    }
}

impl Info {
    fn of_scene(scene: &Scene, notes: Vec<String>) -> Info {
        let splats = || scene.splats.iter();
        let lengths = || splats().map(|splat| splat.axes.map(vector::length));
        let longest = lengths().map(|axes| axes.into_iter().fold(0.0, f64::max));
        let shortest = lengths().map(|axes| axes.into_iter().fold(f64::INFINITY, f64::min));
        let (mut kind, weight) = match scene.weight {
            Weight::Opacity => ("3D Gaussians", "opacity"),
            Weight::Mass => (
                "volume, a splat per voxel that the transfer function shows",
                "mass (extinction times volume)",
            ),
        };
        let are_flat = splats().all(|splat| splat.axes[2] == [0.0; 3]);
        if are_flat && scene.weight == Weight::Opacity {
            kind = "2D Gaussians, drawn as flat 3D ones";
        }
        let colours = splats().flat_map(|splat| splat.colour);
        let ranges = [
            ShownRange::new("longest axis", longest),
            ShownRange::new("shortest axis", shortest),
            ShownRange::new(weight, splats().map(|splat| splat.weight)),
            ShownRange::new("colour without harmonics", colours),
        ];
        let harmonics = scene.harmonics.as_ref();
        Info {
            kind,
            count: scene.splats.len(),
            bounds: scene.bounds().map(|bounds| [bounds.least, bounds.greatest]),
            ranges: ranges.into_iter().flatten().collect(),
            harmonics_degree: harmonics.map_or(0, |harmonics| harmonics.degree),
            rules: scene.natural_rules.name,
            order: scene.order.name(),
            dropped: counted([
                ("non_finite", scene.skipped.non_finite),
                ("zero_rotation", scene.skipped.zero_rotation),
            ]),
            notes,
            ..Info::framed(&scene.name, &FramingInput::of_scene(scene, None))
        }
    }

    fn of_surface(cloud: &SurfaceScene, is_height_field: bool) -> Info {
        let points = || cloud.points.iter();
        let radii = points().map(|point| vector::length(point.frame[0]));
        let ranges = [
            ShownRange::new("radius", radii),
            ShownRange::new("opacity", points().map(|point| point.opacity)),
            ShownRange::new("colour", points().flat_map(|point| point.colour)),
        ];
        let frame = FramingInput::of_surface(cloud, is_height_field, None);
        Info {
            kind: if is_height_field {
                "height field (drawn with --as surface)"
            } else {
                "points of a surface (drawn with --as surface)"
            },
            count: cloud.points.len(),
            bounds: cloud.bounds().map(|bounds| [bounds.least, bounds.greatest]),
            ranges: ranges.into_iter().flatten().collect(),
            rules: "surf",
            dropped: counted([("unusable", cloud.skipped)]),
            notes: cloud.notes.clone(),
            ..Info::framed(&cloud.name, &frame)
        }
    }

    fn framed(name: &str, frame: &FramingInput) -> Info {
        Info {
            format: "splatline-info/1",
            scene: name.to_owned(),
            ball: frame.ball,
            up: frame.up,
            front: frame.front,
            order: SortOrder::Depth.name(),
            ..Info::default()
        }
    }

    fn text(&self) -> String {
        let place = |v: &Vector| format!("{:.6},{:.6},{:.6}", v[0], v[1], v[2]);
        let dropped = match named(&self.dropped) {
            none if none.is_empty() => "nothing".to_owned(),
            dropped => dropped,
        };
        let (radius, strays) = (self.ball.radius, self.ball.strays);
        let framed = if radius.is_finite() {
            let centre = place(&self.ball.centre);
            format!("ball of radius {radius:.6} around {centre}, {strays} strays outside")
        } else {
            "no ball: coordinates are too large or too far apart to place a camera".to_owned()
        };
        let bounds = self.bounds.as_ref();
        let bounds = bounds.map(|[least, most]| format!("{} to {}", place(least), place(most)));
        let [up, front] = [self.up, self.front].map(direction);
        let mut facts = vec![("count", self.count.to_string()), ("dropped", dropped)];
        facts.extend(bounds.map(|bounds| ("bounds", bounds)));
        facts.extend([
            ("framed", framed),
            ("up", format!("{up}, seen from {front}")),
            ("rules", format!("{}, sorted by {}", self.rules, self.order)),
            ("harmonics", format!("degree {}", self.harmonics_degree)),
        ]);
        let mut text = format!("{}: {}\n", self.scene, self.kind);
        for (name, fact) in facts {
            text += &format!("{name:<10} {fact}\n");
        }
        for range in &self.ranges {
            let [least, greatest, median] = [range.least, range.greatest, range.median].map(number);
            let of = range.of;
            text += &format!("{of:<31} {least} to {greatest}, median {median}\n");
        }
        for note in &self.notes {
            text += &format!("note       {note}\n");
        }
        text
    }
}

/// A number of a range, which may be beyond all numbers: a radius whose square overflows.
fn number(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.4e}")
    } else {
        "beyond 1.8e308".to_owned()
    }
}

impl ShownRange {
    fn new(of: &'static str, values: impl Iterator<Item = f64>) -> Option<ShownRange> {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        Some(ShownRange {
            of,
            least: *values.first()?,
            median: *values.get(values.len() / 2)?,
            greatest: *values.last()?,
        })
    }
}

//! Popping of sheet buffers at 45 degrees: axis-aligned against image-aligned.

use super::standard24;
use crate::gallery::Exhibit;
use crate::gallery::sheet::part;
use crate::study::popping::{PoppingOrbit, orbit};
use splatline_sim::picture::Picture;
use splatline_sim::scene::{self, LoadOptions};
use splatline_sim::sheets::SheetKind;
use std::path::Path;

const EQUATION: &str = "[EWA] 4.1; [SWAN] 3";

/// Frames of the orbit and pixels of their side.
const FRAMES: usize = 24;
const SIZE: usize = 320;

/// The part of a frame that the volume's shadow falls into: first and last column, first and last row, as parts of the side.
const SHOWN: [[f64; 2]; 2] = [[0.2, 0.8], [0.33, 0.67]];

/// What differences are multiplied by in the pictures.
const GAIN: f64 = 20.0;

fn shown(orbits: &[PoppingOrbit]) -> Exhibit {
    let caption = format!(
        "Fuel, {FRAMES} frames a quarter of a degree apart around 45 degrees, where axis-aligned sheets switch their axis: the \
         frame before, the frame after, and their difference times {GAIN}. \"Times the usual\" is over the median of all \
         other steps of the same orbit: 1 is no popping. Fixed against float is measured in the frame before."
    );
    let mut exhibit = super::exhibit("sheets", EQUATION, caption);
    for orbit in orbits {
        let name = orbit.kind.name();
        let [before, after] = &orbit.at_switch;
        let difference = difference(before, after);
        let titled =
            |title: &str, picture: &Picture| (format!("{name}, {title}"), cropped(picture));
        exhibit.pictures.push(titled("before", before));
        exhibit.pictures.push(titled("after", after));
        exhibit.pictures.push(titled("difference", &difference));
        let (at, jump) = (orbit.changes[orbit.switch], orbit.jump());
        exhibit.number(
            format!("{name}: mean change across 45 degrees"),
            at.mean,
            "",
        );
        exhibit.number(
            format!("{name}: mean change, times the usual"),
            jump.mean,
            "",
        );
        exhibit.number(
            format!("{name}: largest change across 45 degrees"),
            at.largest,
            "",
        );
        exhibit.number(
            format!("{name}: largest change, times the usual"),
            jump.largest,
            "",
        );
        let what = |group: &str| format!("{name}: fixed against float, {group}");
        exhibit.errors(&what("colour"), &orbit.errors.colour);
        exhibit.errors(&what("alpha"), &orbit.errors.alpha);
    }
    exhibit
}

pub fn exhibit(data: &Path) -> Exhibit {
    let path = data.join("volumes/fuel.nhdr");
    let scene = match scene::load(&path, &LoadOptions::default()) {
        Ok(scene) => scene,
        Err(error) => return not_drawn(&error),
    };
    let design = standard24();
    let orbits: Result<Vec<PoppingOrbit>, _> = SheetKind::ALL
        .into_iter()
        .map(|kind| orbit(&scene, kind, &design, FRAMES, SIZE))
        .collect();
    match orbits {
        Ok(orbits) => shown(&orbits),
        Err(error) => not_drawn(&error),
    }
}

fn not_drawn(error: &dyn std::error::Error) -> Exhibit {
    super::exhibit(
        "sheets",
        EQUATION,
        format!("Not drawn: {error}. Name the folder with the data by --data."),
    )
}

/// The part of a frame that is shown.
fn cropped(frame: &Picture) -> Picture {
    let side = |part: f64| (part * SIZE as f64) as usize;
    let [[left, right], [top, bottom]] = SHOWN.map(|range| range.map(side));
    part(frame, [left, top], [right - left, bottom - top])
}

/// Absolute difference of the colours times [`GAIN`].
fn difference(a: &Picture, b: &Picture) -> Picture {
    let mut shown = a.clone();
    for (shown, b) in shown.pixels.iter_mut().zip(&b.pixels) {
        for channel in 0..3 {
            shown[channel] = (GAIN * (shown[channel] - b[channel]).abs()).min(1.0);
        }
        shown[3] = 1.0;
    }
    shown
}

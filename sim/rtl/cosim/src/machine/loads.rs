//! Frames that the machine draws: small ones that show what goes wrong between its units, and captured scenes.

use crate::circuit::Circuit;
use crate::harmonics::loads::{HarmonicsSplat, of_scene};
use crate::order::{OrderLoad, ordered};
use crate::scenes::Seen;
use crate::setup::program::ProgramKind;
use splatline_sim::camera::Camera;
use splatline_sim::fixed::QuantisedScene;
use splatline_sim::hybrid::spacing;
use splatline_sim::machine::workload::Workload;
use splatline_sim::rules::Antialias;
use splatline_sim::scene::synthetic;

/// A scene, its work for the model, and its lists.
pub struct MachineLoad {
    /// The scene and its camera.
    pub seen: Seen,
    /// The scene and its rules in the kernel's formats.
    pub scene: QuantisedScene,
    /// What the model clocks.
    pub workload: Workload,
    /// The lists of its tiles.
    pub lists: OrderLoad,
    /// Harmonics of the splats for a machine that makes their colours, all of one degree.
    pub harmonics: Option<Vec<HarmonicsSplat>>,
    /// Cycles that model and circuit may be apart: what happens once in a frame is not modelled.
    pub apart: u64,
}

impl MachineLoad {
    /// Of a scene. With distance scaling it has the spacing of its samples; a machine for harmonics is given them apart
    /// from the splats, which keep colours that it must not use.
    pub fn new(mut seen: Seen, circuit: &Circuit, apart: u64) -> MachineLoad {
        if circuit.program.kind == ProgramKind::DistanceScaling {
            let spacing = Antialias::Swan(spacing(&seen.scene));
            seen.scene.natural_rules = seen.scene.natural_rules.with_antialias(spacing);
        }
        let harmonics = seen.scene.harmonics.take_if(|_| circuit.program.directs);
        let rules = seen.scene.natural_rules;
        let (_, workload, lists) = ordered(&seen, &circuit.design, &rules);
        let scene = QuantisedScene::new(&seen.scene, &seen.camera, &rules);
        let harmonics = harmonics.map(|of| of_scene(&of, &circuit.design.widths, &scene));
        MachineLoad {
            scene,
            seen,
            workload,
            lists,
            harmonics,
            apart,
        }
    }
}

/// Random harmonics for a scene that has none.
pub fn add_harmonics(seen: &mut Seen, degree: u8) {
    let count = seen.scene.splats.len();
    let random = || synthetic::random_harmonics(count, 1, degree % 5).harmonics;
    seen.scene.harmonics = seen.scene.harmonics.take().or_else(random);
}

pub const ROW: &str = "row";

/// A crowd with lists that end within words, culled splats and tiles cut by the edge; a few splats among tiles without
/// any, of which some are at the edges; a single row of pixels, whose many tiles are looked up while those without
/// splats are written; and one tile alone with more splats than wait for it, behind which no word is on its way when
/// its pixels begin to leave.
pub fn small() -> Vec<Seen> {
    let mut row = Seen::random(ROW, (40, 3, 0.5), [8_000, 8_000]);
    // As wide as a scene: the vertical focal length alone is so small that every splat meets it.
    row.camera = Camera {
        fy: 1.0,
        cy: 0.5,
        height: 1,
        ..row.camera
    };
    vec![
        Seen::random("crowd", (120, 9, 4.0), [70, 45]),
        Seen::random("sparse", (7, 5, 2.0), [200, 100]),
        row,
        Seen::random("tile", (300, 4, 20.0), [32, 32]),
    ]
}

/// Many splats that are seen, then twelve that are culled: these leave the queue behind packets that waited for their
/// colours.
pub fn gaps() -> Seen {
    let mut gaps = Seen::random("gaps", (400, 7, 2.0), [64, 64]);
    for (number, splat) in gaps.scene.splats.iter_mut().enumerate() {
        if number % 128 >= 116 {
            splat.centre[0] += 1e4;
        }
    }
    gaps
}

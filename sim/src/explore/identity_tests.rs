//! Two sweeps that differ in anything are two sweeps: every fact is changed, one at a time, and must be noticed and
//! named.

use super::*;
use crate::camera::Camera;
use crate::design::DesignChoice;
use crate::explore::folder::claim;
use crate::machine::area::{Calibration, Family};
use crate::machine::config::{Config, SETTINGS};
use crate::machine::energy::{EnergyTable, SHIPPED};
use crate::picture::Picture;
use crate::plan::Technique;
use crate::rules::{Compositing, Rules};
use crate::scene::points::synthetic::{Paint, sphere};
use crate::scene::{points, synthetic};
use proptest::prelude::*;
use splatline::format::{Traversal, WIDTH_RANGES};
use std::sync::Arc;

const SPACE: &str = "[machine]\nlanes = [1, 2]\n";

/// Everything that a subject borrows, so that it can be changed.
#[derive(Clone)]
struct Facts {
    scene: Scene,
    camera: Camera,
    rules: Rules,
    compositing: Compositing,
    design: String,
    traversal: Option<Traversal>,
    machine: Config,
    calibration: Calibration,
    energy: EnergyTable,
    errors: bool,
    settings: Vec<SettingsText>,
    space: String,
}

impl Facts {
    fn new() -> Facts {
        let mut scene = synthetic::random_gaussians(3, 1, 2.0);
        scene.harmonics = Some(Harmonics {
            degree: 1,
            coefficients: vec![[0.1, 0.2, 0.3]; 9],
            base: vec![[0.5; 3]; 3],
        });
        Facts {
            camera: synthetic::camera(48, 32),
            rules: scene.natural_rules,
            scene,
            compositing: Compositing::FrontToBack,
            design: "base = \"standard24\"\n".to_owned(),
            traversal: None,
            machine: Config::default(),
            calibration: Calibration::default(),
            energy: EnergyTable::default(),
            errors: false,
            settings: vec![("transfer", "a = 1\n".to_owned())],
            space: SPACE.to_owned(),
        }
    }

    fn identity(&self) -> Identity {
        let picture = Picture::new(1, 1);
        let design = DesignChoice::from_toml("d.toml", &self.design).unwrap();
        let (scene, camera) = (self.scene.clone(), self.camera.clone());
        let mut prepared = Prepared::of_splats(scene, camera, self.rules, design);
        if let Technique::Splats(splats) = &mut prepared.plan.technique {
            splats.compositing = self.compositing;
        }
        let subject = Subject {
            traversal: self.traversal,
            machine: self.machine,
            calibration: self.calibration.clone(),
            energy: self.energy.clone(),
            references: self.errors.then_some(picture).into_iter().collect(),
            ..Subject::new(vec![Arc::new(prepared)]).unwrap()
        };
        Identity::new(&subject, &self.space, &self.settings).unwrap()
    }
}

/// One bit of a double, so that even the smallest change counts.
fn flip(value: &mut f64, bit: u32) {
    *value = f64::from_bits(value.to_bits() ^ 1 << (bit % 52));
}

/// Changes of a splat.
fn change_splat(scene: &mut Scene, which: usize, bit: u32) {
    let splat = &mut scene.splats[which % 3];
    match which / 3 % 16 {
        axis @ 0..3 => flip(&mut splat.centre[axis], bit),
        axis @ 3..12 => flip(&mut splat.axes.as_flattened_mut()[axis - 3], bit),
        12 => flip(&mut splat.weight, bit),
        axis => flip(&mut splat.colour[axis - 13], bit),
    }
}

fn change_scene(facts: &mut Facts, which: usize, bit: u32) -> &'static str {
    let scene = &mut facts.scene;
    let harmonics = scene.harmonics.as_mut().unwrap();
    let flip_single = |value: &mut f32| *value = f32::from_bits(value.to_bits() ^ 1 << (bit % 23));
    match which % 10 {
        0 => {
            scene.splats.pop();
        }
        1 => scene.splats.swap(0, 1),
        2 => flip_single(&mut harmonics.coefficients[which % 9][which % 3]),
        3 => flip_single(&mut harmonics.base[which % 3][which % 3]),
        4 => harmonics.degree = 2,
        5 => scene.harmonics = None,
        6 => scene.weight = Weight::Mass,
        7 => scene.skipped.non_finite += 1,
        8 => {
            scene.name.push('2');
            return "scene.name";
        }
        _ => change_splat(scene, which, bit),
    }
    "scene.sha256"
}

fn change_camera(camera: &mut Camera, which: usize, bit: u32) -> &'static str {
    match which % 12 {
        0 => camera.width += 1,
        1 => camera.height += 1,
        2 => flip(&mut camera.fx, bit),
        3 => flip(&mut camera.fy, bit),
        4 => flip(&mut camera.cx, bit),
        5 => flip(&mut camera.cy, bit),
        6 => flip(&mut camera.near, bit),
        7 => camera.far = 1000.0 + f64::from(bit),
        8 => camera.orthographic = !camera.orthographic,
        9 => camera.translation[which % 3] += 1.0,
        _ => camera.rotation[which % 3][which / 3 % 3] += 1e-9,
    }
    "camera."
}

fn change_rules(rules: &mut Rules, which: usize, bit: u32) -> &'static str {
    let other = if rules.normalised {
        Rules::GAUSSIAN_3D
    } else {
        Rules::EWA
    };
    match which % 11 {
        10 => rules.compensated = !rules.compensated,
        0 => rules.normalised = !rules.normalised,
        1 => flip(&mut rules.low_pass, bit),
        2 => rules.spacing += 0.5,
        3 => rules.kernel = crate::rules::Kernel::Disc,
        4 => rules.cutoff = 3.0 + f64::from(bit),
        5 => flip(&mut rules.alpha_max, bit),
        6 => rules.alpha_min += 1e-6,
        7 => flip(&mut rules.minimum_transmittance, bit),
        8 => rules.omit_finishing = !rules.omit_finishing,
        _ => *rules = other,
    }
    "rules"
}

fn change_design(facts: &mut Facts, which: usize) -> &'static str {
    match which % (WIDTH_RANGES.len() + 3) {
        0 => {
            facts.traversal = Some(Traversal::Box);
            return "traversal";
        }
        1 => facts.design.push_str("rounding = \"truncate\"\n"),
        2 => facts.design.push_str("traversal = \"box\"\n"),
        width => {
            let (key, low, _) = WIDTH_RANGES[width - 3];
            // A radial index this short needs a table of fewer intervals.
            let low = if key == "radial" { low + 2 } else { low };
            facts.design.push_str(&format!("{key} = {low}\n"));
        }
    }
    "design."
}

fn change_machine(machine: &mut Config, which: usize) -> &'static str {
    let setting = &SETTINGS[which % SETTINGS.len()];
    let known = setting.value(machine);
    let mut values = setting.limits().into_iter();
    let other = values.find(|value| *value != known).unwrap();
    machine.set("test", &setting.key, &other).unwrap();
    "machine, line"
}

fn change_prices(prices: &mut Calibration, which: usize, bit: u32) -> &'static str {
    match which % 8 {
        0 => flip(&mut prices.luts.setup.at_zero, bit),
        1 => flip(&mut prices.luts.lane.per_bit, bit),
        2 => flip(&mut prices.flip_flops.rest, bit),
        3 => prices.multiplier[which % 2] += 1,
        4 => prices.shapes[0][which % 2] += 1,
        5 => flip(&mut prices.luts_per_dsp, bit),
        6 => prices.lut_memory = None,
        _ => *prices = Family::Ice40.calibration(),
    }
    "calibration."
}

/// Changes one fact; the answer is what the message must name.
fn change(facts: &mut Facts, kind: usize, which: usize, bit: u32) -> &'static str {
    match kind {
        0 => change_scene(facts, which, bit),
        1 => change_camera(&mut facts.camera, which, bit),
        2 => change_rules(&mut facts.rules, which, bit),
        3 => change_design(facts, which),
        4 => change_machine(&mut facts.machine, which),
        5 => change_prices(&mut facts.calibration, which, bit),
        6 => {
            facts.errors = !facts.errors;
            "errors"
        }
        7 => {
            facts.compositing = [Compositing::BackToFront, Compositing::XRay][which % 2];
            "compositing"
        }
        8 => {
            facts.settings[0].1.push('#');
            "files_sha256.transfer"
        }
        9 => {
            facts.settings.push(("machine", String::new()));
            "files_sha256.machine"
        }
        10 => {
            let text = SHIPPED.replace("pj = 0.1\n", &format!("pj = 0.2{}\n", bit % 10));
            facts.energy = EnergyTable::from_toml("e.toml", &text).unwrap();
            "energy.adder"
        }
        _ => {
            facts.space.push_str("row_fifo = [1]\n");
            "space, line"
        }
    }
}

/// Kinds of [`change`].
const KINDS: usize = 12;

fn check(kind: usize, which: usize, bit: u32) -> Result<(), TestCaseError> {
    let known = Facts::new();
    let mut other = known.clone();
    let named = change(&mut other, kind, which, bit);
    let (known, other) = (known.identity(), other.identity());
    let read = Identity::parse(&known.to_text()).unwrap();
    prop_assert!(known.differences(&read).is_empty(), "what is read back");
    for (a, b) in [(&known, &other), (&other, &known)] {
        let printed = a.differences(b);
        let names = printed.iter().any(|line| line.starts_with(named));
        prop_assert!(names, "{named}: {printed:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    claim(folder.path(), &known).unwrap();
    let refused = claim(folder.path(), &other).unwrap_err().to_string();
    prop_assert!(refused.contains("holds another sweep"), "{refused}");
    claim(folder.path(), &known).unwrap();
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn two_sweeps_that_differ_in_anything_are_two_sweeps(kind in 0..KINDS, which in 0usize..1000, bit in 0u32..52) {
        check(kind, which, bit)?;
    }
}

/// What the sampled test above may miss by chance: every kind, with every field of the larger ones.
#[test]
fn every_field_counts() {
    for kind in 0..KINDS {
        for which in 0..SETTINGS.len() {
            check(kind, which, 3).unwrap();
        }
    }
}

#[test]
fn an_identity_of_another_version_is_refused() {
    let text = Facts::new().identity().to_text();
    let older = text.replace("splatline-sweep/7", "splatline-sweep/3");
    let message = Identity::parse(&older).unwrap_err().to_string();
    assert!(message.contains("splatline-sweep/3"), "{message}");
    assert!(Identity::parse("{}").is_err() && Identity::parse("x").is_err());
}

/// Every number of a surface, by its last bit; its name is not one.
#[test]
fn every_number_of_a_surface_counts() {
    let paint = Paint {
        colour: [0.9, 0.4, 0.2],
        opacity: 0.6,
        material: 0,
    };
    let surface = points::synthetic::scene("ball", sphere([0.1, 0.2, 0.3], 0.8, 3, paint));
    let changes: [fn(&mut SurfaceScene); 15] = [
        |scene| flip(&mut scene.points[2].centre[1], 0),
        |scene| flip(&mut scene.points[0].frame[1][2], 0),
        |scene| flip(&mut scene.points[1].normal[0], 0),
        |scene| flip(&mut scene.points[1].weight, 0),
        |scene| flip(&mut scene.points[1].opacity, 0),
        |scene| flip(&mut scene.points[1].colour[2], 0),
        |scene| scene.points[1].material += 1,
        |scene| scene.points.swap(0, 1),
        |scene| flip(&mut scene.materials[0].ambient, 0),
        |scene| flip(&mut scene.materials[0].specular, 0),
        |scene| scene.materials[0].exponent += 1,
        |scene| flip(&mut scene.radius, 0),
        |scene| flip(&mut scene.up[2], 0),
        |scene| scene.skipped += 1,
        |scene| scene.coloured = !scene.coloured,
    ];
    let digest = of_surface(&surface);
    for (number, change) in changes.into_iter().enumerate() {
        let mut other = surface.clone();
        change(&mut other);
        assert_ne!(of_surface(&other), digest, "change {number}");
    }
    let renamed = SurfaceScene {
        name: "another".to_owned(),
        ..surface
    };
    assert_eq!(of_surface(&renamed), digest);
}

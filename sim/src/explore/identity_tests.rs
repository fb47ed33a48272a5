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
use crate::rules::{Compositing, Kernel, Rules};
use crate::scene::points::synthetic::{Paint, sphere};
use crate::scene::{points, synthetic};
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

/// The last bit of a double.
fn flip(value: &mut f64) {
    *value = f64::from_bits(value.to_bits() ^ 1);
}

fn flip_single(value: &mut f32) {
    *value = f32::from_bits(value.to_bits() ^ 1);
}

fn change_splat(facts: &mut Facts, which: usize) {
    let splat = &mut facts.scene.splats[which / 16];
    match which % 16 {
        axis @ 0..3 => flip(&mut splat.centre[axis]),
        axis @ 3..12 => flip(&mut splat.axes.as_flattened_mut()[axis - 3]),
        12 => flip(&mut splat.weight),
        axis => flip(&mut splat.colour[axis - 13]),
    }
}

fn harmonics(facts: &mut Facts) -> &mut Harmonics {
    facts.scene.harmonics.as_mut().unwrap()
}

fn change_width(facts: &mut Facts, which: usize) {
    let (key, low, _) = WIDTH_RANGES[which];
    // A radial index this short needs a table of fewer intervals.
    let low = if key == "radial" { low + 2 } else { low };
    facts.design.push_str(&format!("{key} = {low}\n"));
}

fn change_machine(facts: &mut Facts, which: usize) {
    let setting = &SETTINGS[which];
    let known = setting.value(&facts.machine);
    let mut values = setting.limits().into_iter();
    let other = values.find(|value| *value != known).unwrap();
    facts.machine.set("test", &setting.key, &other).unwrap();
}

fn change_energy(facts: &mut Facts) {
    let text = SHIPPED.replace("pj = 0.1\n", "pj = 0.2\n");
    facts.energy = EnergyTable::from_toml("e.toml", &text).unwrap();
}

/// What a message must name, how many changes it is of, and each of them.
type Change = (&'static str, usize, fn(&mut Facts, usize));

fn changes() -> Vec<Change> {
    vec![
        ("scene.sha256", 3 * 16, change_splat),
        ("scene.sha256", 1, |f, _| f.scene.splats.truncate(2)),
        ("scene.sha256", 1, |f, _| f.scene.splats.swap(0, 1)),
        ("scene.sha256", 27, |f, n| {
            flip_single(&mut harmonics(f).coefficients[n / 3][n % 3])
        }),
        ("scene.sha256", 9, |f, n| {
            flip_single(&mut harmonics(f).base[n / 3][n % 3])
        }),
        ("scene.sha256", 1, |f, _| harmonics(f).degree = 2),
        ("scene.sha256", 1, |f, _| f.scene.harmonics = None),
        ("scene.sha256", 1, |f, _| f.scene.weight = Weight::Mass),
        ("scene.sha256", 1, |f, _| f.scene.skipped.non_finite += 1),
        ("scene.name", 1, |f, _| f.scene.name.push('2')),
        ("camera.", 1, |f, _| f.camera.width += 1),
        ("camera.", 1, |f, _| f.camera.height += 1),
        ("camera.", 1, |f, _| flip(&mut f.camera.fx)),
        ("camera.", 1, |f, _| flip(&mut f.camera.fy)),
        ("camera.", 1, |f, _| flip(&mut f.camera.cx)),
        ("camera.", 1, |f, _| flip(&mut f.camera.cy)),
        ("camera.", 1, |f, _| flip(&mut f.camera.near)),
        ("camera.", 1, |f, _| f.camera.far = 1000.0),
        ("camera.", 1, |f, _| f.camera.orthographic = true),
        ("camera.", 3, |f, n| f.camera.translation[n] += 1.0),
        ("camera.", 9, |f, n| f.camera.rotation[n / 3][n % 3] += 1e-9),
        ("rules", 1, |f, _| f.rules.normalised = true),
        ("rules", 1, |f, _| flip(&mut f.rules.low_pass)),
        ("rules", 1, |f, _| f.rules.compensated = true),
        ("rules", 1, |f, _| f.rules.spacing += 0.5),
        ("rules", 1, |f, _| f.rules.kernel = Kernel::Disc),
        ("rules", 1, |f, _| f.rules.cutoff = 3.0),
        ("rules", 1, |f, _| flip(&mut f.rules.alpha_max)),
        ("rules", 1, |f, _| f.rules.alpha_min += 1e-6),
        ("rules", 1, |f, _| flip(&mut f.rules.minimum_transmittance)),
        ("rules", 1, |f, _| {
            f.rules.omit_finishing = !f.rules.omit_finishing
        }),
        ("rules", 1, |f, _| f.rules = Rules::EWA),
        ("compositing", 2, |f, n| {
            f.compositing = [Compositing::BackToFront, Compositing::XRay][n]
        }),
        ("traversal", 1, |f, _| f.traversal = Some(Traversal::Box)),
        ("design.", 1, |f, _| f.design += "rounding = \"truncate\"\n"),
        ("design.", 1, |f, _| f.design += "traversal = \"box\"\n"),
        ("design.", WIDTH_RANGES.len(), change_width),
        ("machine, line", SETTINGS.len(), change_machine),
        ("calibration.", 1, |f, _| {
            flip(&mut f.calibration.luts.setup.at_zero)
        }),
        ("calibration.", 1, |f, _| {
            flip(&mut f.calibration.luts.lane.per_bit)
        }),
        ("calibration.", 1, |f, _| {
            flip(&mut f.calibration.flip_flops.rest)
        }),
        ("calibration.", 2, |f, n| f.calibration.multiplier[n] += 1),
        ("calibration.", 2, |f, n| f.calibration.shapes[0][n] += 1),
        ("calibration.", 1, |f, _| {
            flip(&mut f.calibration.luts_per_dsp)
        }),
        ("calibration.", 1, |f, _| f.calibration.lut_memory = None),
        ("calibration.", 1, |f, _| {
            f.calibration = Family::Ice40.calibration()
        }),
        ("energy.adder", 1, |f, _| change_energy(f)),
        ("errors", 1, |f, _| f.errors = true),
        ("files_sha256.transfer", 1, |f, _| f.settings[0].1.push('#')),
        ("files_sha256.machine", 1, |f, _| {
            f.settings.push(("machine", String::new()))
        }),
        ("space, line", 1, |f, _| f.space += "row_fifo = [1]\n"),
    ]
}

#[test]
fn two_sweeps_that_differ_in_anything_are_two_sweeps() {
    let facts = Facts::new();
    let known = facts.identity();
    let read = Identity::parse(&known.to_text()).unwrap();
    assert!(known.differences(&read).is_empty(), "what is read back");
    let folder = tempfile::tempdir().unwrap();
    claim(folder.path(), &known).unwrap();
    for (named, count, change) in changes() {
        for which in 0..count {
            let mut other = facts.clone();
            change(&mut other, which);
            let other = other.identity();
            for (a, b) in [(&known, &other), (&other, &known)] {
                let printed = a.differences(b);
                let names = printed.iter().any(|line| line.starts_with(named));
                assert!(names, "{named}, {which}: {printed:?}");
            }
            let refused = claim(folder.path(), &other).unwrap_err().to_string();
            assert!(refused.contains("holds another sweep"), "{refused}");
        }
    }
    claim(folder.path(), &known).unwrap();
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
        |scene| flip(&mut scene.points[2].centre[1]),
        |scene| flip(&mut scene.points[0].frame[1][2]),
        |scene| flip(&mut scene.points[1].normal[0]),
        |scene| flip(&mut scene.points[1].weight),
        |scene| flip(&mut scene.points[1].opacity),
        |scene| flip(&mut scene.points[1].colour[2]),
        |scene| scene.points[1].material += 1,
        |scene| scene.points.swap(0, 1),
        |scene| flip(&mut scene.materials[0].ambient),
        |scene| flip(&mut scene.materials[0].specular),
        |scene| scene.materials[0].exponent += 1,
        |scene| flip(&mut scene.radius),
        |scene| flip(&mut scene.up[2]),
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

//! A plan's results as a report, and a plan out of a report.

use super::{Depiction, DesignVariant, Engine, Look, Measured, Plan, Prepared};
use crate::camera::Camera;
use crate::design::traversal_name;
use crate::hybrid::Hybrid;
use crate::input;
use crate::report::facts::{CameraFacts, RulesFacts, SceneFacts};
use crate::report::{FORMAT, HostTimes, Report};
use crate::rules::{Kernel, Rules};
use crate::scene::Weight;
use crate::scene::points::SurfaceScene;
use crate::surface::{Buffer, Style};
use crate::systems::{SystemVerdict, Use, exercised};
use anyhow::{Context, Result, bail};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::path::Path;
use std::sync::Arc;

impl Prepared {
    /// The plan that a report records, with its scene loaded again; `doing` is told of what takes long.
    pub fn from_report(path: &Path, doing: &dyn Fn(String)) -> Result<Prepared> {
        let shown = path.display();
        let text =
            input::text(path, input::TABLE).with_context(|| format!("cannot read '{shown}'"))?;
        let plan = Plan::from_report(&text).with_context(|| format!("'{shown}'"))?;
        let loaded = plan.source.load(doing)?;
        Ok(Prepared {
            plan,
            scene: Arc::new(loaded.scene),
            warnings: Vec::new(),
            prepare_s: loaded.seconds,
        })
    }

    /// Name of the traversal in reports.
    pub fn traversal_name(&self, entry: &DesignVariant) -> &'static str {
        match self.plan.look {
            Look::Splats {
                hybrid: Some(hybrid),
                ..
            } => match hybrid {
                Hybrid {
                    phase_bits: Some(_),
                    ..
                } => "stamp",
                _ => "spans",
            },
            _ => traversal_name(entry.traversal),
        }
    }

    /// Which systems of the papers drawing it exercises.
    pub fn systems(&self) -> Vec<SystemVerdict> {
        match (&self.plan.look, self.subject()) {
            (_, Ok(Depiction::Splats(splats))) => exercised(&Use::Volume {
                rules: splats.rules,
                compositing: splats.compositing,
                hybrid: splats.hybrid,
                classified: splats.scene.weight == Weight::Mass,
            }),
            (Look::Surface(style), _) => exercised(&Use::Surface {
                style,
                textured: self.plan.source.is_textured(),
            }),
            _ => Vec::new(),
        }
    }
}

impl Plan {
    /// The plan that the text of a report records.
    pub fn from_report(text: &str) -> Result<Plan> {
        let report: Report = serde_json::from_str(text).context("not a report.json")?;
        if report.plan.is_null() {
            bail!(
                "it records no \"plan\": write it again with this version's render --json or compare"
            );
        }
        serde_json::from_value(report.plan).context("its \"plan\" is none of this version")
    }

    /// How pixels gather, in a report's words.
    fn compositing(&self) -> String {
        match &self.look {
            Look::Splats { compositing, .. } => compositing.name().to_owned(),
            Look::Surface(style) => match style.buffer {
                Buffer::Accumulation => "accumulation".to_owned(),
                Buffer::Layers(count) => format!("{count} layers"),
            },
        }
    }
}

/// The report of one picture through the kernel that was compared with nothing.
pub fn report_of_entry(
    prepared: &Prepared,
    entry: &DesignVariant,
    measured: &Measured,
) -> Result<Report> {
    Ok(Report {
        design: Some(entry.design.resolved()),
        traversal: Some(prepared.traversal_name(entry).to_owned()),
        ..report_of_drawing(prepared, Engine::Fixed, measured)?
    })
}

/// The report of one picture by whatever engine, without design and traversal.
pub fn report_of_drawing(
    prepared: &Prepared,
    engine: Engine,
    measured: &Measured,
) -> Result<Report> {
    let plan = &prepared.plan;
    let scene = scene_facts(prepared, measured);
    Ok(Report {
        format: FORMAT.to_owned(),
        engine: engine.name().to_owned(),
        reference: None,
        design: None,
        traversal: None,
        warnings: scene.warnings(&prepared.warnings),
        scene,
        camera: CameraFacts::from(&plan.camera),
        rules: match &plan.look {
            Look::Splats { rules, .. } => RulesFacts::from(rules),
            Look::Surface(style) => surface_rules(style),
        },
        compositing: plan.compositing(),
        error: None,
        systems: prepared.systems(),
        error_map: None,
        cycles: None,
        pace: None,
        pixels: measured.drawing.pixels,
        host: HostTimes {
            prepare_s: prepared.prepare_s + measured.host.prepare_s,
            ..measured.host
        },
        table: Vec::new(),
        formats: Vec::new(),
        plan: serde_json::to_value(plan)?,
    })
}

fn scene_facts(prepared: &Prepared, measured: &Measured) -> SceneFacts {
    let drawing = &measured.drawing;
    let (culled, clamped) = (drawing.culled.clone(), drawing.clamped);
    match &*prepared.scene {
        super::AnyScene::Splats(scene) => {
            SceneFacts::new(scene, culled, clamped, drawing.colour_log2)
        }
        super::AnyScene::Surface { scene, .. } => SceneFacts {
            culled,
            clamped,
            ..surface_facts(scene)
        },
    }
}

fn surface_facts(scene: &SurfaceScene) -> SceneFacts {
    let skipped = (scene.skipped > 0).then(|| ("unusable".to_owned(), scene.skipped as u64));
    SceneFacts {
        name: scene.name.clone(),
        splats: scene.points.len() as u64,
        skipped: skipped.into_iter().collect(),
        ..SceneFacts::default()
    }
}

/// A style in the terms of rules.
fn surface_rules(style: &Style) -> RulesFacts {
    RulesFacts {
        name: "surf".to_owned(),
        normalised: false,
        low_pass: style.low_pass,
        spacing: 0.0,
        kernel: "gaussian".to_owned(),
        cutoff: Some(style.cutoff),
        alpha_max: 1.0,
        alpha_min: 0.0,
        minimum_transmittance: 0.0,
        omit_finishing: false,
        clamp_jacobian: false,
    }
}

/// A camera as a report states it; reading it back gives the same bits.
pub(super) mod camera {
    use super::*;

    pub fn serialize<S: Serializer>(camera: &Camera, to: S) -> Result<S::Ok, S::Error> {
        CameraFacts::from(camera).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Camera, D::Error> {
        let facts = CameraFacts::deserialize(from)?;
        let text = serde_json::to_string(&facts).map_err(D::Error::custom)?;
        Camera::from_json_str(&text).map_err(D::Error::custom)
    }
}

/// Rules as a report states them: the named ones with every number its own.
pub(super) mod rules {
    use super::*;

    pub fn serialize<S: Serializer>(rules: &Rules, to: S) -> Result<S::Ok, S::Error> {
        RulesFacts::from(rules).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Rules, D::Error> {
        let facts = RulesFacts::deserialize(from)?;
        let named: Rules = facts.name.parse().map_err(D::Error::custom)?;
        let kernels = [
            Kernel::Gaussian,
            Kernel::Cubic,
            Kernel::Quadratic,
            Kernel::Disc,
        ];
        let rules = |kernel| Rules {
            name: named.name,
            normalised: facts.normalised,
            low_pass: facts.low_pass,
            spacing: facts.spacing,
            kernel,
            cutoff: facts.cutoff.unwrap_or(f64::INFINITY),
            alpha_max: facts.alpha_max,
            alpha_min: facts.alpha_min,
            minimum_transmittance: facts.minimum_transmittance,
            omit_finishing: facts.omit_finishing,
            clamp_jacobian: facts.clamp_jacobian,
        };
        let all = kernels.map(rules);
        // By the name that a report gives it, so that it is spelled in one place.
        let found = all
            .iter()
            .find(|rules| RulesFacts::from(*rules).kernel == facts.kernel);
        found.copied().ok_or_else(|| {
            let kernel = &facts.kernel;
            D::Error::custom(format!(
                "kernel '{kernel}': expected gaussian, cubic, quadratic or disc"
            ))
        })
    }
}

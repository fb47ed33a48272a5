//! A plan's results as a report, and a plan out of a report.

use super::exercised::exercised;
use super::{AnyScene, DesignVariant, Drawing, Engine, Plan, Prepared, SplatMethod, Technique};
use crate::design::traversal_name;
use crate::hybrid::Hybrid;
use crate::report::facts::SceneFacts;
use crate::report::{FORMAT, HostTimes, Report};
use crate::rules::Rules;
use crate::scene::Weight;
use crate::surface::Buffer;
use crate::systems::SystemVerdict;
use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use serde_json::Value;
use splatline::format::Traversal;

impl Prepared {
    /// Name of the traversal in reports.
    pub fn traversal_name(&self, entry: &DesignVariant) -> &'static str {
        let Technique::Splats(splats) = &self.plan.technique else {
            return traversal_name(entry.traversal);
        };
        match splats.method {
            SplatMethod::Points(Hybrid {
                phase_bits: Some(_),
                ..
            }) => "stamp",
            SplatMethod::Points(_) | SplatMethod::Spheres(_) => traversal_name(Traversal::Spans),
            _ => traversal_name(entry.traversal),
        }
    }

    /// Which systems of the papers drawing it exercises.
    pub fn systems(&self) -> Vec<SystemVerdict> {
        let classified = match &*self.scene {
            AnyScene::Splats(scene) => scene.weight == Weight::Mass,
            AnyScene::Surface { .. } => false,
        };
        let Plan {
            technique, source, ..
        } = &self.plan;
        exercised(technique, &source.contents, classified)
    }
}

/// What is read of a report, of whatever version its other fields are.
#[derive(Deserialize)]
struct RecordedPlan {
    #[serde(default)]
    plan: Value,
}

impl Plan {
    /// The plan that the text of a report records.
    pub fn from_report(text: &str) -> Result<Plan> {
        let report: RecordedPlan = serde_json::from_str(text).context("not a report.json")?;
        ensure!(
            !report.plan.is_null(),
            "it records no \"plan\": write it again with this version's render --json or compare"
        );
        serde_json::from_value(report.plan).context("its \"plan\" is none of this version")
    }

    /// How pixels gather, in a report's words.
    fn compositing(&self) -> String {
        match &self.technique {
            Technique::Splats(splats) => match splats.method {
                SplatMethod::Sheets(sheets) => format!("sheets, {}", sheets.kind.name()),
                _ => splats.compositing.name().to_owned(),
            },
            Technique::Surface(style) => match style.buffer {
                Buffer::Accumulation => "accumulation".to_owned(),
                Buffer::Layers(count) => format!("{count} layers"),
            },
        }
    }
}

/// The report of one picture that was compared with nothing: by the kernel's design, or by another engine.
pub fn report_of(
    prepared: &Prepared,
    engine: Engine,
    entry: Option<&DesignVariant>,
    drawing: &Drawing,
) -> Result<Report> {
    let plan = &prepared.plan;
    let scene = scene_facts(prepared, drawing);
    Ok(Report {
        format: FORMAT.to_owned(),
        engine: engine.name().to_owned(),
        reference: None,
        design: entry.map(|entry| entry.design.resolved()),
        traversal: entry.map(|entry| prepared.traversal_name(entry).to_owned()),
        warnings: scene.warnings(&prepared.warnings),
        scene,
        camera: plan.camera.clone(),
        rules: match &plan.technique {
            Technique::Splats(splats) => splats.rules,
            // A style in the terms of rules.
            Technique::Surface(style) => Rules {
                name: "surf",
                normalised: false,
                low_pass: style.low_pass,
                cutoff: style.cutoff,
                minimum_transmittance: 0.0,
                ..Rules::EWA
            },
        },
        compositing: plan.compositing(),
        error: None,
        systems: prepared.systems(),
        error_map: None,
        cycles: None,
        pace: None,
        pixels: drawing.pixels,
        host: HostTimes {
            prepare_s: prepared.prepare_s + drawing.host.prepare_s,
            ..drawing.host
        },
        table: Vec::new(),
        formats: Vec::new(),
        plan: stated(plan)?,
    })
}

/// The plan as a report states it; JSON is text, so that it cannot name every file that a system can hold.
fn stated(plan: &Plan) -> Result<Value> {
    serde_json::to_value(plan).with_context(|| {
        let scene = plan.source.path.display();
        format!(
            "{scene}: a report names the scene's files, and one of these names is not UTF-8: rename it"
        )
    })
}

fn scene_facts(prepared: &Prepared, drawing: &Drawing) -> SceneFacts {
    let (culled, clamped) = (drawing.culled.clone(), drawing.clamped);
    match &*prepared.scene {
        AnyScene::Splats(scene) => SceneFacts {
            splats: prepared.count as u64,
            ..SceneFacts::new(scene, culled, clamped, drawing.colour_log2)
        },
        AnyScene::Surface { scene, .. } => SceneFacts {
            name: scene.name.clone(),
            splats: scene.points.len() as u64,
            skipped: (scene.skipped > 0)
                .then(|| ("unusable".to_owned(), scene.skipped as u64))
                .into_iter()
                .collect(),
            culled,
            clamped,
            ..SceneFacts::default()
        },
    }
}

//! `splatline vectors`: test vectors for every stage boundary, written and checked.

use super::output::create_folder;
use super::resolve::sound_camera;
use super::say::{print_result, usage};
use super::values::AntialiasChoice;
use super::verification_args::{VectorsAction, VectorsExportOptions};
use crate::design::DesignChoice;
use crate::fixed::QuantisedScene;
use crate::rules::Rules;
use crate::scene::{self, LoadOptions, SortOrder};
use crate::vectors::{self, VectorSubject};
use anyhow::{Result, ensure};
use std::path::Path;

pub fn run(action: &VectorsAction) -> Result<()> {
    match action {
        VectorsAction::Export(options) => export(options),
        VectorsAction::Verify { folder } => verify(folder),
        VectorsAction::Explain { folder, record } => Ok(vectors::explain(folder, record)?),
    }
}

fn export(options: &VectorsExportOptions) -> Result<()> {
    create_folder(&options.folder)?;
    let mut design = DesignChoice::load(&options.design)?;
    if let Some(traversal) = options.traversal {
        design.traversal = traversal.into();
    }
    let [width, height] = options.size;
    let size = [width, height].map(|side| side as u16);
    let (view, splats, rules) = match &options.scene {
        None => {
            vectors::room_for_splats(options.splats)?;
            let (mut view, mut splats) = vectors::hard_cases(options.splats, size, options.seed);
            splats.extend(vectors::stress_cases());
            if options.orthographic {
                vectors::stress_orthographic(&mut view, &mut splats, &design.widths);
            } else {
                vectors::stress_view(&mut view, &design.widths);
            }
            (view, splats, options.rules.unwrap_or(Rules::GAUSSIAN_3D))
        }
        Some(file) => {
            let loaded = scene::load(file, &LoadOptions::default())?;
            let name = &loaded.name;
            ensure!(
                loaded.order == SortOrder::Depth,
                usage(format!(
                    "{name}: it is sorted by distance, and vectors hold the words of a setup unit whose key is the depth: give a scene that is sorted by depth (glTF: \"sortingMethod\": \"zDepth\")"
                ))
            );
            let camera = loaded.default_camera(width, height);
            let camera = sound_camera(camera, &loaded.name)?;
            let rules = options.rules.unwrap_or(loaded.natural_rules);
            let mut quantised = QuantisedScene::new(&loaded, &camera, &rules);
            quantised.splats.truncate(options.splats);
            (quantised.view, quantised.splats, rules)
        }
    };
    let subject = VectorSubject {
        design,
        rules: filtered(rules, options.antialias),
        compositing: options.compositing,
        view,
        splats,
        systems: options.systems,
    };
    let manifest = vectors::export(&options.folder, &subject)?;
    let counts: Vec<String> = manifest
        .stages
        .iter()
        .map(|stage| format!("{} {}", stage.name, stage.records))
        .collect();
    print_result(&format!(
        "{}: {}\n",
        options.folder.display(),
        counts.join(", ")
    ))
}

/// The built-in splats' samples are as far apart as pixels are in the middle of them.
fn filtered(rules: Rules, antialias: Option<AntialiasChoice>) -> Rules {
    const SPACING: f64 = 1.0 / 24.0;
    match antialias {
        Some(choice) => rules.with_antialias(choice.with(rules.low_pass, || SPACING)),
        None => rules,
    }
}

fn verify(folder: &Path) -> Result<()> {
    let verified = vectors::verify(folder)?;
    for (stage, records) in &verified.stages {
        print_result(&format!("{stage}: {records} records equal the kernel's\n"))?;
    }
    for stage in &verified.missing {
        print_result(&format!("{stage}: no file, not checked\n"))?;
    }
    Ok(())
}

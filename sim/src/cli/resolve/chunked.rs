//! What `--chunks` draws: a file that is never in memory as a whole, so that nothing may follow from all of its splats.

use super::camera::camera;
use super::{PlanRequest, scene_of};
use crate::camera::Camera;
use crate::cli::say::Failure;
use crate::cli::values::{AntialiasChoice, TraversalChoice};
use crate::design::DesignChoice;
use crate::plan::{DesignVariant, Engine};
use crate::rules::{Antialias, Compositing, Rules};
use crate::scene::GaussianFile;
use splatline::format::Traversal;

/// What is drawn of a file that is not read as a whole.
pub struct Chunked {
    pub camera: Camera,
    pub warnings: Vec<String>,
    pub rules: Rules,
    pub entry: DesignVariant,
    pub compositing: Compositing,
}

impl PlanRequest<'_> {
    /// What is drawn of a file that is not read as a whole: its camera, its rules and by what.
    pub fn in_chunks(&self, file: &GaussianFile) -> Result<Chunked, Failure> {
        let view = self.view;
        let seen_whole = view.camera.is_none() && view.eye.is_none();
        let refused = [
            (
                seen_whole,
                "needs --camera, or --eye and --target: to be shown whole a scene has to be in memory",
            ),
            (
                view.antialias == Some(AntialiasChoice::Swan),
                "does not know the spacing that --antialias swan needs",
            ),
            (
                self.engine != Engine::Fixed,
                "draws by the engine fixed only",
            ),
            (
                self.traversal == Some(TraversalChoice::Stamp),
                "draws no stamps",
            ),
        ];
        if let Some((_, why)) = refused.iter().find(|(given, _)| *given) {
            return Err(Failure::Usage(format!("--chunks {why}")));
        }
        let unseen = || unreachable!("a camera has been given");
        let (camera, warnings) = camera(view, file.up(), scene_of(view)?, unseen)?;
        let rules = view
            .rules
            .unwrap_or(file.natural_rules())
            .with_kernel(view.kernel);
        let rules = match view.antialias {
            Some(AntialiasChoice::None) => rules.with_antialias(Antialias::None),
            _ => rules,
        };
        let design = DesignChoice::load(&self.design.0)?;
        Ok(Chunked {
            camera,
            warnings,
            rules,
            entry: DesignVariant::new(design, self.traversal.map(Traversal::from)),
            compositing: self.compositing,
        })
    }
}

//! Popping of sheet buffers: a camera orbits a volume through 45 degrees and the change from frame to frame is
//! measured (\[EWA\] 4.1: axis-aligned sheets switch their axis there, image-aligned sheets never do).

use splatline_sim::camera::{Camera, CameraError};
use splatline_sim::design::DesignChoice;
use splatline_sim::fixed::{self, Options};
use splatline_sim::metrics::{CompareError, Errors, compare};
use splatline_sim::picture::Picture;
use splatline_sim::reference;
use splatline_sim::rules::Compositing;
use splatline_sim::scene::Scene;
use splatline_sim::sheets::{SheetKind, SheetPlan};

/// Degrees from frame to frame; no frame stands at exactly 45.
const STEP: f64 = 0.25;

/// The change between two frames, over all colour channels, in units of 1.0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Mean of the absolute differences.
    pub mean: f64,
    /// Largest absolute difference.
    pub largest: f64,
}

/// One kind of sheets along the orbit.
#[derive(Clone, Debug)]
pub struct PoppingOrbit {
    /// Kind of sheets.
    pub kind: SheetKind,
    /// Change from frame to frame.
    pub changes: Vec<Change>,
    /// Index into `changes` of the step across 45 degrees.
    pub switch: usize,
    /// The frames before and after 45 degrees.
    pub at_switch: [Picture; 2],
    /// Fixed against float in the frame before 45 degrees.
    pub errors: Errors,
}

impl PoppingOrbit {
    /// Change across 45 degrees over the median of all others: mean and largest.
    pub fn jump(&self) -> Change {
        let others = |part: fn(&Change) -> f64| {
            let others = self.changes.iter().enumerate();
            let mut others: Vec<f64> = others
                .filter(|(index, _)| *index != self.switch)
                .map(|(_, change)| part(change))
                .collect();
            others.sort_by(f64::total_cmp);
            others.get(others.len() / 2).copied().unwrap_or(0.0)
        };
        let at = self.changes[self.switch];
        Change {
            mean: at.mean / others(|change| change.mean),
            largest: at.largest / others(|change| change.largest),
        }
    }
}

/// Why an orbit could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum OrbitError {
    /// The scene has no extent to orbit around.
    #[error("{0}")]
    Camera(#[from] CameraError),
    /// A picture cannot be compared.
    #[error("{0}")]
    Compare(#[from] CompareError),
}

/// Draws `frames` frames (even, at least 2) around 45 degrees with one kind of sheets, one scene unit thick.
pub fn orbit(
    scene: &Scene,
    kind: SheetKind,
    design: &DesignChoice,
    frames: usize,
    size: usize,
) -> Result<PoppingOrbit, OrbitError> {
    let half = (frames / 2).max(1);
    let angle = |frame: usize| 45.0 + (frame as f64 - half as f64 + 0.5) * STEP;
    let rules = scene.natural_rules;
    let options = Options {
        rules: &rules,
        compositing: Compositing::FrontToBack,
        design,
        traversal: design.traversal,
    };
    let mut pictures = Vec::with_capacity(2 * half);
    let mut errors = None;
    for frame in 0..2 * half {
        let camera = camera(scene, angle(frame), size)?;
        let plan = SheetPlan::new(kind, 1.0, scene, &camera);
        let picture = fixed::sheets::draw(scene, &camera, &options, fixed::best_engine(), &plan);
        if frame + 1 == half {
            let float = reference::sheets::draw(scene, &camera, &rules, &plan).picture;
            errors = Some(compare(&picture, &float)?);
        }
        pictures.push(picture);
    }
    let changes = pictures.windows(2).map(|pair| change(&pair[0], &pair[1]));
    let changes = changes.collect();
    let after = pictures.swap_remove(half);
    let before = pictures.swap_remove(half - 1);
    Ok(PoppingOrbit {
        kind,
        changes,
        switch: half - 1,
        at_switch: [before, after],
        errors: errors.ok_or(CompareError::Empty)?,
    })
}

/// A parallel view of the scene's middle at an angle around y.
fn camera(scene: &Scene, degrees: f64, size: usize) -> Result<Camera, CameraError> {
    let bounds = scene.bounds();
    let (middle, extents) = bounds.map_or(([0.0; 3], [1.0; 3]), |b| (b.centre(), b.extents()));
    let reach = extents.iter().fold(0.0, |m: f64, e| m.max(*e)).max(1.0);
    let angle = degrees.to_radians();
    let eye = [
        middle[0] - 2.0 * reach * angle.sin(),
        middle[1],
        middle[2] - 2.0 * reach * angle.cos(),
    ];
    let mut camera = Camera::look_at(eye, middle, scene.up, 30.0, size, size)?;
    camera.orthographic = true;
    (camera.fx, camera.fy) = (size as f64 / (1.5 * reach), size as f64 / (1.5 * reach));
    Ok(camera)
}

fn change(a: &Picture, b: &Picture) -> Change {
    let mut total = Change::default();
    for (a, b) in a.pixels.iter().zip(&b.pixels) {
        for channel in 0..3 {
            let difference = (a[channel] - b[channel]).abs();
            total.mean += difference;
            total.largest = total.largest.max(difference);
        }
    }
    total.mean /= (3 * a.pixels.len()).max(1) as f64;
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use splatline_sim::scene;
    use std::path::Path;

    /// Largest ratio of the change across 45 degrees to the usual change that counts as no pop, and the least that is one.
    const SMOOTH: f64 = 1.5;
    const POP: f64 = 2.0;

    #[test]
    #[cfg_attr(
        not(has_data),
        ignore = "the shared data were not beside the project when this was built"
    )]
    fn only_axis_aligned_sheets_pop() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../../shared/data/volumes/fuel.nhdr"
        );
        let scene = scene::load(Path::new(file), &Default::default()).unwrap();
        let design = DesignChoice::named("standard24").unwrap();
        for kind in SheetKind::ALL {
            let orbit = orbit(&scene, kind, &design, 8, 96).unwrap();
            let jump = orbit.jump().mean;
            let pops = kind == SheetKind::AxisAligned;
            assert!(
                if pops { jump > POP } else { jump < SMOOTH },
                "{}: {jump}",
                kind.name()
            );
            let (colour, alpha) = (orbit.errors.colour, orbit.errors.alpha);
            for error in [colour, alpha] {
                assert!(
                    error.psnr_db >= 60.0 && error.bias.abs() <= 5e-4,
                    "{}: {} dB, largest {}, bias {}",
                    kind.name(),
                    error.psnr_db,
                    error.max_abs,
                    error.bias
                );
            }
        }
    }
}

//! From a prepared plan to a picture in double precision or in an emulated format.

use super::draw::with_backfaces;
use super::{Drawing, Engine, Prepared, SplatMethod, Splats, Subject};
use crate::hybrid::Hybrid;
use crate::reference::compositor::{self, RowProgress as Rows};
use crate::reference::{self, Counts, Culled, FloatDrawing, exact, float, formats, sphere};
use crate::report::facts::{ReasonCounts, counted};
use crate::rules::{self, Compositing, Rules};
use anyhow::{Result, bail, ensure};

impl Prepared {
    /// Draws by one of the double-precision engines.
    pub fn draw_reference(&self, engine: Engine, rows: Rows) -> Result<Drawing> {
        match self.subject()? {
            Subject::Splats(splats) => {
                let drawn = draw_splats_reference(engine, splats, rows)?;
                Ok(Drawing {
                    culled: reference_culled(&drawn.counts),
                    picture: drawn.picture,
                    ..Drawing::default()
                })
            }
            Subject::Surface(..) if engine.stages().is_some() => {
                let name = engine.name();
                bail!("engine '{name}' draws splats and no surfaces: use fixed or float")
            }
            Subject::Surface(scene, style) => {
                let drawn = reference::surface::draw(scene, &self.plan.camera, style);
                let culled = reference_culled(&drawn.counts);
                Ok(Drawing {
                    culled: with_backfaces(culled, style, drawn.counts.culled(Culled::Backface)),
                    picture: drawn.picture,
                    ..Drawing::default()
                })
            }
        }
    }
}

fn draw_splats_reference(engine: Engine, splats: Splats, rows: Rows) -> Result<FloatDrawing> {
    let (scene, camera, rules) = (splats.scene, splats.camera, splats.rules);
    let (compositing, method) = (splats.compositing, splats.method);
    // A deep alpha channel shows all of its error: no pixel finishes.
    let endless = Rules {
        minimum_transmittance: 0.0,
        omit_finishing: false,
        ..*rules
    };
    let composited = |rules: &Rules| match engine {
        Engine::Exact => {
            let footprints = exact::footprints(scene, camera, rules);
            compositor::draw(&footprints, camera, rules, compositing, rows)
        }
        _ => {
            let footprints = float::footprints(scene, camera, rules);
            compositor::draw(&footprints, camera, rules, compositing, rows)
        }
    };
    match (engine, method) {
        (Engine::Fixed, _) => bail!("engine 'fixed' is not a reference"),
        (Engine::Float | Engine::Exact, SplatMethod::Composited) => Ok(composited(rules)),
        (Engine::Float | Engine::Exact, SplatMethod::DeepAlpha(_)) => Ok(composited(&endless)),
        // The ray integral is what every shape of a sphere stands for.
        (Engine::Exact, SplatMethod::Spheres(_)) => Ok(composited(rules)),
        (Engine::Float, SplatMethod::Spheres(shape)) => {
            Ok(sphere::draw(scene, camera, rules, compositing, *shape))
        }
        (Engine::Float, SplatMethod::Points(hybrid)) => {
            // Centres of points are where they are and not at a stamp's phase.
            let hybrid = Hybrid {
                phase_bits: None,
                ..*hybrid
            };
            Ok(reference::hybrid::draw(scene, camera, rules, &hybrid))
        }
        (Engine::Float, SplatMethod::Sheets(sheets)) => {
            let plan = sheets.plan(scene, camera);
            Ok(reference::sheets::draw(scene, camera, rules, &plan))
        }
        (format, SplatMethod::Composited) if format.stages().is_some() => {
            draw_format(engine, &splats)
        }
        _ => bail!(
            "engine '{}' composites footprints one by one: leave out --points, --traversal stamp, --sheets, --deep-alpha and --spheres, \
             or use float",
            engine.name()
        ),
    }
}

/// What floating-point formats draw: Gaussians from front to back.
fn draw_format(engine: Engine, splats: &Splats) -> Result<FloatDrawing> {
    let name = engine.name();
    if splats.compositing != Compositing::FrontToBack
        || splats.rules.kernel != rules::Kernel::Gaussian
    {
        bail!(
            "engine '{name}' draws Gaussians from front to back: leave --compositing and --kernel out, or use float"
        );
    }
    ensure!(
        splats.rules.spacing <= 0.0,
        "engine '{name}' knows no scaling by distance: leave --antialias out, or use float"
    );
    let single = formats::RoundedStages::pixels(formats::FP32);
    let stages = engine.stages().unwrap_or(single);
    let (scene, camera) = (splats.scene, splats.camera);
    Ok(formats::draw(scene, camera, splats.rules, &stages))
}

fn reference_culled(counts: &Counts) -> ReasonCounts {
    counted([
        ("near", counts.culled(Culled::Near)),
        ("far", counts.culled(Culled::Far)),
        ("outside", counts.culled(Culled::OutsideViewport)),
        ("transparent", counts.culled(Culled::Transparent)),
        ("degenerate", counts.culled(Culled::Degenerate)),
        ("non_finite", counts.culled(Culled::NonFinite)),
    ])
}

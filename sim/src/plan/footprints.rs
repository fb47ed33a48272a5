//! Where each splat of a prepared plan lands, by the kernel's setup and in double precision, in the same words.

use super::{DesignVariant, Prepared, SplatMethod, Splats, Subject};
use crate::fixed;
use crate::reference::{self, Culled, PixelBox, float};
use anyhow::{Result, ensure};
use rayon::prelude::*;
use splatline::footprint::surface::SurfaceFootprint;
use splatline::footprint::{Footprint, depth};
use splatline::format::Widths;

/// Where one splat lands. Pixels; the conic is that of the radial index `r = a dx^2 + 2 b dx dy + c dy^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootprintLine {
    /// Centre.
    pub centre: [f64; 2],
    /// What it is sorted by: the depth along the view, or the distance from the eye where the scene says so.
    pub depth: f64,
    /// a, b, c.
    pub conic: [f64; 3],
    /// x0, y0, x1, y1: first pixel inside, first pixel beyond.
    pub bounds: [usize; 4],
    /// Opacity at the centre, before any clamp; nothing where points of a surface have none of their own.
    pub opacity: Option<f64>,
    /// Radial index at which the footprint ends.
    pub cutoff: f64,
}

impl Prepared {
    /// Footprints by the kernel's setup, in the scene's order; nothing for what is culled.
    pub fn fixed_footprints(&self, entry: &DesignVariant) -> Result<Vec<Option<FootprintLine>>> {
        let widths = &entry.design.widths;
        Ok(match self.subject()? {
            Subject::Splats(splats) => {
                refuse_spheres(&splats)?;
                let found = fixed::footprints(splats.scene, splats.camera, &splats.options(entry));
                let line = |footprint: &Footprint| line_of(footprint, widths);
                found.iter().map(|f| f.as_ref().ok().map(line)).collect()
            }
            Subject::Surface(scene, style) => {
                let points = fixed::surface::QuantisedPoints::new(scene, &self.plan.camera);
                // Surfaces are drawn in units in which their scene fills the depths' range.
                let unit = f64::from(-points.scale_log2).exp2();
                let found = fixed::surface::footprints(&points, style, &entry.design);
                let drawn = found.iter().map(|f| f.as_ref().ok());
                let line = |surface: &SurfaceFootprint| {
                    let line = line_of(&surface.footprint, widths);
                    let depth = line.depth * unit;
                    FootprintLine {
                        depth,
                        opacity: None,
                        ..line
                    }
                };
                drawn
                    .map(|f| f.filter(|f| !(style.cull_backfaces && f.back)))
                    .map(|f| f.map(line))
                    .collect()
            }
        })
    }

    /// Footprints in double precision, in the scene's order; nothing for what is culled.
    pub fn float_footprints(&self) -> Result<Vec<Option<FootprintLine>>> {
        Ok(match self.subject()? {
            Subject::Splats(splats) => {
                refuse_spheres(&splats)?;
                let found = float::footprints(splats.scene, splats.camera, splats.rules);
                let of_splat = |f: &Result<float::Footprint, Culled>| {
                    let f = f.as_ref().ok()?;
                    Some(FootprintLine {
                        centre: f.centre,
                        depth: f.place,
                        conic: f.variance.conic(),
                        bounds: corners(&f.bounds),
                        opacity: Some(f.peak),
                        cutoff: f.cutoff,
                    })
                };
                found.iter().map(of_splat).collect()
            }
            Subject::Surface(scene, style) => {
                let of_point = |point| {
                    let f = reference::surface::project(point, &self.plan.camera, style).ok()?;
                    Some(FootprintLine {
                        centre: f.centre,
                        depth: f.depth,
                        conic: f.conic,
                        bounds: corners(&f.bounds),
                        opacity: None,
                        cutoff: style.cutoff,
                    })
                };
                scene.points.par_iter().map(of_point).collect()
            }
        })
    }
}

/// Spheres have outlines of their own and no affine footprint.
fn refuse_spheres(splats: &Splats) -> Result<()> {
    ensure!(
        !matches!(splats.method, SplatMethod::Spheres(_)),
        "projected spheres have no affine footprints: leave out --spheres"
    );
    Ok(())
}

fn corners(bounds: &PixelBox) -> [usize; 4] {
    [bounds.x0, bounds.y0, bounds.x1, bounds.y1]
}

/// A packet's integers as numbers: depth as a sort key, Q27.subpixel centre, conic mantissas with their exponent.
fn line_of(footprint: &Footprint, widths: &Widths) -> FootprintLine {
    let depth = depth::number(footprint.depth);
    let power_of_two = |power: i32| f64::from(power).exp2();
    let step = power_of_two(-i32::from(widths.subpixel));
    let ([x0, y0], [x1, y1]) = (footprint.first, footprint.end);
    FootprintLine {
        centre: footprint.centre.map(|coordinate| coordinate as f64 * step),
        depth: depth.value as f64 * power_of_two(depth.exponent),
        conic: footprint
            .conic
            .mantissa
            .map(|m| f64::from(m) * power_of_two(footprint.conic.exponent)),
        bounds: [x0, y0, x1, y1].map(usize::from),
        opacity: Some(f64::from(footprint.opacity) * power_of_two(-i32::from(widths.peak))),
        cutoff: f64::from(footprint.cutoff) * power_of_two(-28),
    }
}

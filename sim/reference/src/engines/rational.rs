//! The footprint in exact rational arithmetic, rounded once to double precision at the end.
//!
//! From doubles on, every step of setup up to the quadratic form is rational: t = W u + d, the Jacobian at the
//! (clamped) slope, M = J W A, V = M M^T + h I, its determinant, and the LDL coefficients. Only the peak of normalised
//! kernels needs a root, and is taken in double precision from exact arguments. \[EWA\] 6.2, eq. 22-31.

use super::float::widened_frustum;
use crate::camera::Camera;
use crate::rules::Rules;
use crate::scene::Splat;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// A footprint as it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RationalFootprint {
    /// Centre, pixels.
    pub centre: [f64; 2],
    /// Depth, scene units.
    pub depth: f64,
    /// K: the columns of M before the viewing ray's share is taken off them, against the footprint's own extent, and at
    /// least 1.
    pub cancellation: f64,
    /// Vxx, Vxy, Vyy, square pixels, and the determinant.
    pub variance: [f64; 4],
    /// A = Vyy / det, per square pixel.
    pub horizontal: f64,
    /// S = Vxy / Vyy, pixels per row.
    pub shear: f64,
    /// C = 1 / Vyy, per square pixel.
    pub vertical: f64,
    /// Opacity at r = 0, not yet clamped.
    pub peak: f64,
    /// r at which the footprint ends.
    pub cutoff: f64,
}

impl RationalFootprint {
    /// G = 1 / sqrt(1 - rho^2) with the correlation rho of x and y.
    pub fn gain(&self) -> f64 {
        (1.0 + self.shear * self.shear * self.horizontal / self.vertical).sqrt()
    }

    /// The radial index at a point, a sum of two positive terms.
    pub fn radial(&self, x: f64, y: f64) -> f64 {
        let [dx, dy] = [x - self.centre[0], y - self.centre[1]];
        let across = dx - self.shear * dy;
        self.horizontal * across * across + self.vertical * dy * dy
    }
}

/// Projects one splat, whose weight is as the rules need it; `None` if it is culled by depth, singular or transparent.
pub fn project(splat: &Splat, camera: &Camera, rules: &Rules) -> Option<RationalFootprint> {
    let rotation = camera.rotation.map(|row| row.map(exact));
    let turn = |v: &[BigRational; 3]| -> [BigRational; 3] {
        std::array::from_fn(|row| (0..3).map(|k| &rotation[row][k] * &v[k]).sum())
    };
    let turned = turn(&splat.centre.map(exact));
    let t: [BigRational; 3] =
        std::array::from_fn(|row| &turned[row] + exact(camera.translation[row]));
    let z = &t[2];
    if *z <= exact(camera.near)
        || *z >= exact(camera.far)
        || (!camera.orthographic && !z.is_positive())
    {
        return None;
    }
    let focal = [camera.fx, camera.fy].map(exact);
    let distance = if camera.orthographic {
        BigRational::one()
    } else {
        z.clone()
    };
    let on_plane = [0, 1].map(|i| &t[i] / &distance);
    let centre = [camera.cx, camera.cy].map(exact);
    let centre = [0, 1].map(|i| &focal[i] * &on_plane[i] + &centre[i]);
    let gain = [0, 1].map(|i| &focal[i] / &distance);
    let slope = slopes(&on_plane, camera, rules);
    let turned = splat.axes.map(|axis| turn(&axis.map(exact)));
    let columns = turned
        .each_ref()
        .map(|axis| [0, 1].map(|i| &gain[i] * (&axis[i] - &slope[i] * &axis[2])));
    let product =
        |i: usize, j: usize| -> BigRational { columns.iter().map(|m| &m[i] * &m[j]).sum() };
    let low_pass = exact(rules.low_pass);
    let (xx, xy, yy) = (
        product(0, 0) + &low_pass,
        product(0, 1),
        product(1, 1) + &low_pass,
    );
    let determinant = &xx * &yy - &xy * &xy;
    if determinant.is_zero() || yy.is_zero() {
        return None;
    }
    // Before the subtraction, and with what an error of the slope itself does.
    let before = [0, 1].map(|i| {
        let part = |axis: &[BigRational; 3]| {
            let [across, along] = [&axis[i], &axis[2]].map(|x| double(x).abs());
            double(&gain[i]) * (across + (1.0 + double(&slope[i]).abs()) * along)
        };
        turned.iter().map(|axis| part(axis).powi(2)).sum::<f64>()
    });
    let kept = [double(&xx), double(&yy)];
    let cancellation = (0..2).fold(1.0, |most: f64, i| most.max((before[i] / kept[i]).sqrt()));
    let peak = if rules.normalised {
        let slant = double(&(&slope[0] * &slope[0] + &slope[1] * &slope[1])) + 1.0;
        let area = double(&(&gain[0] * &gain[1]));
        splat.weight * area * (slant / double(&determinant)).sqrt() / std::f64::consts::TAU
    } else {
        splat.weight
    };
    if peak <= 0.0 || peak < rules.alpha_min {
        return None;
    }
    let faint = 2.0 * (peak / rules.alpha_min).ln();
    Some(RationalFootprint {
        centre: centre.each_ref().map(double),
        depth: double(z),
        cancellation,
        variance: [&xx, &xy, &yy, &determinant].map(double),
        horizontal: double(&(&yy / &determinant)),
        shear: double(&(&xy / &yy)),
        vertical: double(&yy.recip()),
        peak,
        cutoff: rules.cutoff.min(faint),
    })
}

/// The slopes of the Jacobian, clamped to the widened frustum if the rules say so; 0 in parallel projection.
fn slopes(on_plane: &[BigRational; 2], camera: &Camera, rules: &Rules) -> [BigRational; 2] {
    let frustum = widened_frustum(camera);
    [0, 1].map(|i| {
        if camera.orthographic {
            return BigRational::zero();
        }
        if !rules.clamp_jacobian {
            return on_plane[i].clone();
        }
        let [low, high] = frustum[i].map(exact);
        on_plane[i].clone().min(high).max(low)
    })
}

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).unwrap_or_else(BigRational::zero)
}

fn double(value: &BigRational) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

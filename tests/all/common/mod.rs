//! What the integration tests share: scenes, an oracle in double precision, and the table of tolerances.
//!
//! The oracle is the textbook's formulas, written without a look at the kernel: it evaluates the quantised
//! inputs, so that what differs is the kernel's arithmetic alone.
#![allow(missing_docs)]

#[cfg(feature = "float")]
pub mod pictures;
pub mod tolerances;

use fixed::types::{I2F30, I32F32, U4F28};
use proptest::prelude::*;
use splatline::math::{Extended, SoftFloat};
use splatline::rules::Rules;
use splatline::splat::{Axis, VolumeSplat};
use splatline::view::{Eye, Projection, RatioLimits, Rotation, View};

pub const SIZE: u16 = 96;

/// The nearest normalised number of 31 bits.
pub fn scaled(value: f64) -> SoftFloat {
    if value == 0.0 {
        return SoftFloat::ZERO;
    }
    let exponent = value.abs().log2().floor() as i32 - 40;
    SoftFloat::from_wide((value * f64::from(-exponent).exp2()) as i64, exponent, 31)
}

/// A double as it is.
pub fn extended(value: f64) -> Extended {
    let exponent = value.abs().max(1e-300).log2().floor() as i32 - 52;
    Extended {
        value: (value * f64::from(-exponent).exp2()) as i64,
        exponent,
    }
}

/// A rotation in the kernel's two parts.
pub fn rotation(rows: [[f64; 3]; 3]) -> (Rotation, [[i32; 3]; 3]) {
    let fine = rows.map(|row| row.map(|entry| (entry * 60f64.exp2()) as i64));
    let coarse = fine.map(|row| row.map(|entry| (entry + (1 << 29)) >> 30));
    let rest = [0, 1, 2].map(|i| [0, 1, 2].map(|j| (fine[i][j] - (coarse[i][j] << 30)) as i32));
    (
        coarse.map(|row| row.map(|entry| I2F30::from_bits(entry as i32))),
        rest,
    )
}

/// The rotation in double precision.
pub fn rotation_of(view: &View) -> [[f64; 3]; 3] {
    let entry = |i: usize, j: usize| {
        let rest = f64::from(view.pose.rotation_rest[i][j]);
        view.rotation[i][j].to_num::<f64>() + rest / 60f64.exp2()
    };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

/// The eye, and a centre's difference to it, in double precision.
pub fn from_eye(view: &View, centre: &[SoftFloat; 3]) -> [f64; 3] {
    let unit = f64::from(view.pose.exponent).exp2();
    [0, 1, 2].map(|i| double(centre[i]) - view.pose.position[i] as f64 * unit)
}

pub fn double(value: SoftFloat) -> f64 {
    f64::from(value.mantissa) * f64::from(value.exponent).exp2()
}

/// A camera at the origin, turned by `yaw` and `pitch`, 96x96 pixels.
pub fn view(yaw: f64, pitch: f64, projection: Projection) -> View {
    let (sy, cy) = yaw.sin_cos();
    let (sp, cp) = pitch.sin_cos();
    let rotation = [
        [cy, 0.0, -sy],
        [sp * sy, cp, sp * cy],
        [cp * sy, -sp, cp * cy],
    ];
    let limit = [0.8, 0.9].map(I32F32::from_num);
    let translation = [0.1, -0.2, 4.0];
    let eye = [0, 1, 2].map(|i| -dot([0, 1, 2].map(|row| rotation[row][i]), translation));
    let (rotation, rotation_rest) = self::rotation(rotation);
    View {
        rotation,
        pose: Eye {
            position: eye.map(|e| (e * 50f64.exp2()) as i64),
            exponent: -50,
            rotation_rest,
        },
        focal: match projection {
            Projection::Perspective => [scaled(90.0), scaled(95.0)],
            Projection::Orthographic => [scaled(20.0), scaled(21.0)],
        },
        principal: [I32F32::from_num(47.3), I32F32::from_num(48.9)],
        near: extended(0.01),
        far: extended(250.0),
        viewport: [SIZE; 2],
        projection,
        limits: RatioLimits {
            low: limit.map(|l| -l),
            high: limit,
        },
    }
}

/// Splats from harmless to hostile: needles, discs, far larger and smaller than the screen.
pub fn splats() -> impl Strategy<Value = VolumeSplat> {
    let direction = prop::array::uniform3(-1.0f64..1.0);
    let size = prop_oneof![
        Just([-2.0, -2.0, -2.0]).boxed(),
        prop::array::uniform3(-5.0f64..0.0).boxed(),
        (-14.0f64..2.0).prop_map(|thin| [2.0, thin, thin]).boxed(),
        (-17.0f64..2.0).prop_map(|thin| [thin, 1.0, 1.0]).boxed(),
        Just([8.0, 7.0, 8.0]).boxed(),
        Just([-14.0, -15.0, -14.0]).boxed(),
    ];
    (
        prop::array::uniform3(-2.0f64..2.0),
        direction.clone(),
        direction,
        size,
        0.002f64..1.0,
        prop::array::uniform3(0.0f64..2.0),
    )
        .prop_map(
            |(centre, first, second, size, weight, colour)| VolumeSplat {
                centre: centre.map(scaled),
                axes: axes(first, second, size),
                weight: scaled(weight),
                colour: colour.map(U4F28::from_num),
            },
        )
}

/// Three orthogonal axes of lengths 2^size.
fn axes(first: [f64; 3], second: [f64; 3], size: [f64; 3]) -> [Axis; 3] {
    let unit = |v: [f64; 3]| {
        let length = dot(v, v).sqrt();
        if length < 1e-3 {
            [1.0, 0.0, 0.0]
        } else {
            v.map(|c| c / length)
        }
    };
    let a = unit(first);
    let along = dot(second, a);
    let b = unit([0, 1, 2].map(|i| second[i] - along * a[i]));
    let c = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    let mut index = 0;
    [a, b, c].map(|direction| {
        let length = size[index].exp2();
        index += 1;
        Axis::from_components(direction.map(|d| scaled(d * length)))
    })
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Every quantity of setup in double precision.
#[derive(Clone, Copy, Debug)]
pub struct Oracle {
    pub camera: [f64; 3],
    pub centre: [f64; 2],
    pub columns: [[f64; 2]; 3],
    pub variance: [f64; 3],
    pub determinant: f64,
    pub conic: [f64; 3],
    /// sqrt(det V' / det(V' + V^h)).
    pub kept: f64,
    pub peak: f64,
}

/// EWA setup of one splat under `rules`, without culling.
pub fn oracle(view: &View, rules: &Rules, splat: &VolumeSplat) -> Oracle {
    let rotation = rotation_of(view);
    let turn = |v: [f64; 3]| [0, 1, 2].map(|row| dot(rotation[row], v));
    let camera = turn(from_eye(view, &splat.centre));
    let focal = view.focal.map(double);
    let perspective = view.projection == Projection::Perspective;
    let depth = if perspective { camera[2] } else { 1.0 };
    let centre = [0, 1].map(|i| focal[i] * camera[i] / depth + view.principal[i].to_num::<f64>());
    let ratio = [0, 1].map(|i| match (perspective, rules.clamp_jacobian) {
        (false, _) => 0.0,
        (true, false) => camera[i] / depth,
        (true, true) => {
            (camera[i] / depth).clamp(view.limits.low[i].to_num(), view.limits.high[i].to_num())
        }
    });
    let gain = focal.map(|f| f / depth);
    let columns = splat.axes.map(|axis| {
        let a = turn(
            axis.mantissa
                .map(|m| f64::from(m) * f64::from(axis.exponent).exp2()),
        );
        [0, 1].map(|i| gain[i] * (a[i] - ratio[i] * a[2]))
    });
    let h = double(rules.low_pass);
    let sum = |i: usize, j: usize| columns.iter().map(|c| c[i] * c[j]).sum::<f64>();
    let variance = [sum(0, 0) + h, sum(0, 1), sum(1, 1) + h];
    let minor = |j: usize, k: usize| columns[j][0] * columns[k][1] - columns[j][1] * columns[k][0];
    let minors = minor(0, 1).powi(2) + minor(0, 2).powi(2) + minor(1, 2).powi(2);
    let determinant = minors + h * (sum(0, 0) + sum(1, 1)) + h * h;
    let conic = [
        variance[2] / determinant,
        -variance[1] / determinant,
        variance[0] / determinant,
    ];
    let weight = double(splat.weight);
    let slant = (1.0 + ratio[0].powi(2) + ratio[1].powi(2)).sqrt();
    let normalised =
        weight * gain[0] * gain[1] * slant / (std::f64::consts::TAU * determinant.sqrt());
    Oracle {
        camera,
        centre,
        columns,
        variance,
        determinant,
        conic,
        kept: (minors / determinant).sqrt(),
        peak: match (rules.normalised, rules.compensated) {
            (true, _) => normalised,
            (false, true) => weight * (minors / determinant).sqrt(),
            (false, false) => weight,
        },
    }
}

/// Largest difference of an entry over the largest entry.
pub fn relative(got: &[f64], exact: &[f64]) -> f64 {
    let largest = exact.iter().fold(0.0f64, |m, e| m.max(e.abs()));
    let difference = got
        .iter()
        .zip(exact)
        .fold(0.0f64, |m, (g, e)| m.max((g - e).abs()));
    if largest == 0.0 {
        difference
    } else {
        difference / largest
    }
}

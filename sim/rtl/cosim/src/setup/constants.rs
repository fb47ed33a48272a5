//! What the setup unit has to be told of a picture: camera and rules as numbers of 64 bits with an exponent, each at
//! its address.
//!
//! Nothing here is computed for a splat. As `Blend::new` does for the pixels, thresholds and limits are brought into
//! the form in which the circuit compares them; every one is exact, or the kernel's own value.

use super::program::low_bits;
use super::text;
use crate::circuit::Circuit;
use anyhow::{Context, Result, bail, ensure};
use splatline::format::Widths;
use splatline::kernel::Kernel;
use splatline::math::{Extended, LN_2, SoftFloat, fraction, ln, shift_round};
use splatline::rules::{Cutoff, Rules, THRESHOLD};
use splatline::setup::axis_bits;
use splatline::view::{Projection, View, round_entry};

/// An address, a value, an exponent.
pub type Constant = (u8, i64, i32);

/// The picture's constants for a circuit's program, at the addresses at which it reads them.
pub fn constants(circuit: &Circuit, view: &View, rules: &Rules) -> Result<Vec<Constant>> {
    let widths = &circuit.design.widths;
    let program = circuit.program.assembled(widths)?;
    let names = &program.constants;
    let known = [
        turn(widths, view),
        registers(view, rules),
        screen(widths, view, rules)?,
        of_rules(rules)?,
        compensation(names, rules)?.into_iter().collect(),
        distance_scaling(names, view, rules)?,
        fixed().to_vec(),
    ]
    .concat();
    let mut words = Vec::new();
    let names = (0..).zip(names.iter().map(String::as_str));
    for (address, name) in names.chain(text::registers_of(&program)) {
        let found = known.iter().find(|(known, ..)| known == name);
        let found = found.with_context(|| format!("there is no constant '{name}'"))?;
        words.push((address, found.1, found.2));
    }
    let fits = |word: &Constant| word.2.abs() < 1 << 16;
    ensure!(
        words.iter().all(fits),
        "an exponent of camera or rules has no place in 18 bits"
    );
    Ok(words)
}

/// Beyond every fixed-point number of a core.
const BEYOND: i64 = 1 << 62;

type Named = (String, i64, i32);

fn named(name: &str, value: i64, exponent: i32) -> Named {
    (name.to_owned(), value, exponent)
}

/// A mantissa as the core has them, 31 bits of which the last may be 0: a sum's window follows from that length.
fn number(name: &str, value: SoftFloat) -> Named {
    if value.mantissa == 0 {
        return named(name, 0, ZERO_EXPONENT);
    }
    let value = SoftFloat::from_wide(value.mantissa.into(), value.exponent, 31);
    named(name, value.mantissa.into(), value.exponent)
}

/// The exponent of 0 in `setup_core.sv`.
const ZERO_EXPONENT: i32 = -3 << 14;

/// W for positions, in two parts where they have two, for axes, and as it is, by which a direction is turned back.
fn turn(widths: &Widths, view: &View) -> Vec<Named> {
    let low = low_bits(widths);
    let mut all = Vec::new();
    let drop = 30u32.saturating_sub(low);
    for (row, r) in ['x', 'y', 'z'].iter().enumerate() {
        for (column, c) in ['x', 'y', 'z'].iter().enumerate() {
            let entry = view.rotation[row][column];
            let rest = shift_round(view.pose.rotation_rest[row][column].into(), drop);
            let position = round_entry(entry, widths.position.into());
            all.push(named(&format!("turn_{r}{c}"), position, -30));
            all.push(named(&format!("rest_{r}{c}"), rest, -30 - low as i32));
            let axis = round_entry(entry, axis_bits(widths));
            all.push(named(&format!("axis_{r}{c}"), axis, -30));
            all.push(named(&format!("back_{r}{c}"), entry.to_bits().into(), 0));
        }
    }
    all
}

fn screen(widths: &Widths, view: &View, rules: &Rules) -> Result<Vec<Named>> {
    let bits = u32::from(widths.mantissa);
    let perspective = view.projection == Projection::Perspective;
    let mut all = Vec::new();
    for (axis, name) in ["u", "v"].into_iter().enumerate() {
        let [low, high] = [view.limits.low, view.limits.high].map(|end| end[axis].to_bits());
        let principal = view.principal[axis].to_bits();
        let fits = |number: i64| number.unsigned_abs() < 1 << 59;
        ensure!(
            fits(principal),
            "principal point: the setup unit takes it within 2^27 pixels"
        );
        ensure!(
            !rules.clamp_jacobian || fits(low) && fits(high),
            "limits: the setup unit takes them below 2^27"
        );
        all.push(number(&format!("focal_{name}"), view.focal[axis]));
        all.push(named(&format!("principal_{name}"), principal, -32));
        let (below, above, least, most) = if !perspective {
            // Everything lies below the limit, which is 0.
            (-BEYOND, BEYOND, SoftFloat::ZERO, SoftFloat::ZERO)
        } else if rules.clamp_jacobian {
            let limit = |fixed| SoftFloat::from_wide(fixed, -32, bits);
            (low.saturating_neg(), high, limit(low), limit(high))
        } else {
            (BEYOND, BEYOND, SoftFloat::ZERO, SoftFloat::ZERO)
        };
        all.push(named(&format!("below_{name}"), below, -32));
        all.push(named(&format!("above_{name}"), above, -32));
        all.push(number(&format!("least_{name}"), least));
        all.push(number(&format!("most_{name}"), most));
    }
    Ok(all)
}

fn of_rules(rules: &Rules) -> Result<Vec<Named>> {
    let SoftFloat { mantissa, exponent } = rules.kernel.inverse_integral();
    let smallest = SoftFloat::from_wide((rules.alpha_min >> 1) as i64, 1 - THRESHOLD as i32, 31);
    let (least, cutoff) = match rules.cutoff {
        Cutoff::Radial(cutoff) => (0, cutoff.min(rules.kernel.end())),
        Cutoff::Opacity => match (by_opacity(rules), ln(smallest)) {
            (false, _) => (0, rules.kernel.end()),
            (true, Some(least)) => (least, 15 << 28),
            (true, None) => {
                bail!("alpha_min = 0: a cut-off by the opacity needs a smallest opacity")
            }
        },
    };
    // Where the opacity has no say, every logarithm lies beyond the end.
    let (end, power) = if by_opacity(rules) {
        (15 << 20, -21)
    } else {
        (-(1 << 30), -10)
    };
    Ok(vec![
        number("low_pass", rules.low_pass),
        named("inverse_integral", mantissa.into(), exponent - 1),
        named("ln_least", LN_2 * 30 + ((9 - (least << 1)) << 7), -40),
        named("logarithm_end", end, power),
        named("cutoff_end", cutoff.into(), -29),
    ])
}

/// What only a program with compensated opacities asks for; it compensates all, and others none.
fn compensation(names: &[String], rules: &Rules) -> Result<Option<Named>> {
    let compensates = names.iter().any(|name| name == "one_half");
    ensure!(
        !rules.compensated || compensates,
        "--antialias mip: this setup unit's program compensates no opacity; build the unit with it, or draw with --antialias ewa"
    );
    ensure!(
        rules.compensated || !compensates,
        "--antialias: this setup unit's program compensates every opacity; draw with --antialias mip"
    );
    Ok(compensates.then(|| named("one_half", 1 << 30, -31)))
}

/// A spacing so large that no splat lies beyond k.
const FAR_APART: SoftFloat = SoftFloat {
    mantissa: 1,
    exponent: 1 << 14,
};

/// What only a program with distance scaling asks for.
fn distance_scaling(names: &[String], view: &View, rules: &Rules) -> Result<Vec<Named>> {
    let scales = rules.spacing.mantissa > 0;
    if !names.iter().any(|name| name == "spacing") {
        ensure!(
            !scales,
            "spacing: this setup unit's program has no distance scaling; set it to 0, or build the unit with it"
        );
        return Ok(Vec::new());
    }
    let [across, down] = view.focal;
    ensure!(
        across.mantissa > 0 && down.mantissa > 0,
        "focal: distance scaling in hardware needs focal lengths above 0"
    );
    let order = |focal: SoftFloat| {
        let normal = SoftFloat::from_wide(focal.mantissa.into(), focal.exponent, 31);
        (normal.exponent, normal.mantissa)
    };
    let smaller = [down, across][usize::from(order(across) < order(down))];
    let spacing = if scales { rules.spacing } else { FAR_APART };
    Ok(vec![
        number("smaller_focal", smaller),
        number("spacing", spacing),
    ])
}

/// Does a footprint end where its opacity falls below the smallest one?
fn by_opacity(rules: &Rules) -> bool {
    rules.cutoff == Cutoff::Opacity && rules.kernel == Kernel::Gaussian
}

fn fixed() -> [Named; 11] {
    [
        named("one", 1 << 30, -30),
        named("reciprocal_one", 1 << 47, -47),
        named("below_one", (1 << 47) - 1, -47),
        named("logarithm_one", -(1 << 36), -36),
        named("fifth", fraction(5).into(), -30),
        named("quarter", fraction(4).into(), -30),
        named("third", fraction(3).into(), -30),
        named("half", fraction(2).into(), -30),
        named("ln_2_high", LN_2 >> 9, -40),
        named("ln_2_low", LN_2 & 0x1ff, -49),
        named("nothing", 0, ZERO_EXPONENT),
    ]
}

/// Below every leading bit.
const NO_EYE: i32 = -16_384;

/// What stands in registers of its own, outside the cores.
fn registers(view: &View, rules: &Rules) -> Vec<Named> {
    let eye = &view.pose;
    let flags = i64::from(view.projection == Projection::Perspective)
        | i64::from(rules.normalised) << 1
        | i64::from(by_opacity(rules)) << 2
        | i64::from(view.viewport[0]) << 16
        | i64::from(view.viewport[1]) << 32;
    let [x, y, z] = eye.position;
    let largest = [x, y, z].iter().fold(0, |all, c| all | c.unsigned_abs());
    let top = match 64 - largest.leading_zeros() as i32 {
        0 => NO_EYE,
        length => eye.exponent + length,
    };
    let (near, near_leading) = limit(view.near);
    let (far, far_leading) = limit(view.far);
    vec![
        named("eye_x", x, eye.exponent),
        named("eye_y", y, top),
        named("eye_z", z, eye.exponent),
        named("flags", flags, 0),
        named("near", near, near_leading),
        named("far", far, far_leading),
    ]
}

/// A limit of depth as a sign and a magnitude, its leading bit as far up as it goes, and that bit's power. What lies
/// beyond every depth stays there.
fn limit(depth: Extended) -> (i64, i32) {
    if depth.value == 0 {
        return (0, 0);
    }
    let value = match depth.value.unsigned_abs().leading_zeros() {
        0 => depth.value / 2,
        spare => depth.value << (spare - 1),
    };
    let leading = depth.leading();
    let magnitude = value.unsigned_abs() as i64;
    (magnitude | value & i64::MIN, leading.clamp(-30_000, 30_000))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program that does something else than the rules say is refused by name.
    #[test]
    fn compensation_is_the_programs_or_refused() {
        let compensated = Rules {
            compensated: true,
            ..Rules::GAUSSIAN_3D
        };
        let check = |name: &str, rules: &Rules| {
            let named = compensation(&[name.to_owned()], rules).map_err(|error| error.to_string());
            named.map(|named| named.is_some())
        };
        let refused = |found: Result<bool, String>| found.is_err_and(|e| e.contains("--antialias"));
        assert!(refused(check("one", &compensated)));
        assert!(refused(check("one_half", &Rules::GAUSSIAN_3D)));
        assert_eq!(check("one_half", &compensated), Ok(true));
        assert_eq!(check("one", &Rules::GAUSSIAN_3D), Ok(false));
    }
}

//! What a core of `setup_unit.sv` computes: the kernel's setup as a list of sums, each one line of `src/setup`.
//!
//! The list says nothing of the arithmetic: what a sum, a rounding or a table is stands in `setup_core.sv`. Names are the kernel's.

use super::assemble::{Operand, Pick, Program, Table, Term, Unit, Value};
use super::builder::{Builder, constant, cut, less, plain, product, taken_off, value};
use super::distance;
use anyhow::Result;
use splatline::format::Widths;
use splatline::math::GUARD;

/// Items of a record: the difference to the eye (high and low parts), the axes, the weight.
pub const ITEMS: u8 = 16;
/// High parts of the difference.
pub const HIGH: u8 = 0;
/// Its low parts.
pub const LOW: u8 = 3;
/// Nine components of the axes.
pub const AXES: u8 = 6;
/// The weight.
pub const WEIGHT: u8 = 15;

/// Flags: the view is perspective, the rules normalise kernels, the cut-off follows from the opacity.
pub const PERSPECTIVE: u8 = 0;
/// Kernels are normalised.
pub const NORMALISED: u8 = 1;
/// The opacity decides where a footprint ends.
pub const BY_OPACITY: u8 = 2;

/// Bits of the difference's low part; 0 where it has none.
pub fn low_bits(widths: &Widths) -> u32 {
    u32::from(widths.position).saturating_sub(30)
}

/// What makes a design's program.
pub type SetupProgram = fn(&Widths) -> Result<Program>;

/// What protects a program's splats against samples closer together than pixels, beside the low-pass filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protection {
    /// Nothing.
    Filter,
    /// Distance scaling; rules without a spacing do without it.
    DistanceScaling,
    /// Opacities compensated for the filter, under rules that do so.
    Compensation,
}

/// The program of a design, for rules without a spacing.
pub fn program(widths: &Widths) -> Result<Program> {
    of_setup(widths, Protection::Filter)
}

/// The same with distance scaling.
pub fn with_distance_scaling(widths: &Widths) -> Result<Program> {
    of_setup(widths, Protection::DistanceScaling)
}

/// The same with compensated opacities.
pub fn with_compensation(widths: &Widths) -> Result<Program> {
    of_setup(widths, Protection::Compensation)
}

fn of_setup(widths: &Widths, protection: Protection) -> Result<Program> {
    let mut all = Builder::default();
    let builder = &mut all;
    let (view, mantissa) = (u32::from(widths.view), u32::from(widths.mantissa));
    let [x, y, z, depth_high, depth_low] = to_camera(builder, widths);
    let weight = Operand::Input(WEIGHT);
    let weight = builder.add("weight", vec![plain(weight)], Unit::First(0), None);
    let turned = turned_axes(builder, mantissa);
    let projected = project(builder, [x, y, z], view, mantissa);
    let mut columns = shear(builder, &turned, &projected, mantissa);
    let mut dimmed = weight;
    if protection == Protection::DistanceScaling {
        let enlargement = distance::enlargement(builder, projected.inverse, mantissa);
        columns = distance::enlarge(builder, columns, &enlargement, mantissa);
        dimmed = distance::dim(builder, weight, &enlargement, mantissa);
    }
    let covariance = covariance(builder, &columns, mantissa);
    let shape = shape(builder, &covariance, mantissa);
    let mut weight = weight;
    if protection == Protection::Compensation {
        weight = compensate(builder, weight, &covariance, shape.inverse, mantissa);
        dimmed = weight;
    }
    let normalised = peak(builder, weight, &projected, shape.inverse, mantissa);
    let rule = Pick::Flag(NORMALISED);
    let peak = builder.pick("peak", rule, normalised, value(dimmed), None);
    let cutoff = cutoff(builder, peak);
    let roots = extents(builder, cutoff, &covariance);
    let [[high_u, low_u], [high_v, low_v]] = projected.position;
    all.finish([
        [depth_low, peak],
        [low_u, cutoff],
        [low_v, roots[0]],
        [roots[1], shape.horizontal],
        [shape.squared_width, shape.shear],
        [shape.vertical, shape.cross],
        [shape.conic_c, high_u],
        [depth_high, high_v],
    ])
}

/// A program that is no setup: the record's weight (beside a term of 0) through rounding, reciprocal, root and logarithm, each into a field of the packet that only
/// [`Layout`](splatline::footprint::packet::Layout) touches on its way (`shear`, `vertical`, `horizontal`, cut-off). For vectors of those units alone.
pub fn units(widths: &Widths) -> Result<Program> {
    let mut all = Builder::default();
    let builder = &mut all;
    let bits = u32::from(widths.mantissa);
    let given = builder.add(
        "given",
        vec![plain(Operand::Input(WEIGHT))],
        Unit::First(0),
        None,
    );
    let nothing = builder.round("nothing", Operand::Input(AXES), 31);
    let nothing = plain(value(nothing));
    let whole = builder.round("31 bits", value(given), 31);
    let shear = builder.sum("rounded", vec![plain(value(whole)), nothing], bits);
    let vertical = builder.reciprocal("reciprocal", whole, bits);
    let twice = square_root(builder, "root", whole, bits);
    let squared_width = builder.root("root, 16 bits", whole, 16);
    let cutoff = cutoff(builder, given);
    all.finish([
        [given, given],
        [given, cutoff],
        [given, given],
        [given, twice],
        [squared_width, shear],
        [vertical, shear],
        [shear, given],
        [given, given],
    ])
}

const TURN: [[&str; 3]; 3] = [
    ["turn_xx", "turn_xy", "turn_xz"],
    ["turn_yx", "turn_yy", "turn_yz"],
    ["turn_zx", "turn_zy", "turn_zz"],
];
const REST: [[&str; 3]; 3] = [
    ["rest_xx", "rest_xy", "rest_xz"],
    ["rest_yx", "rest_yy", "rest_yz"],
    ["rest_zx", "rest_zy", "rest_zz"],
];
const AXIS: [[&str; 3]; 3] = [
    ["axis_xx", "axis_xy", "axis_xz"],
    ["axis_yx", "axis_yy", "axis_yz"],
    ["axis_zx", "axis_zy", "axis_zz"],
];

/// `Eye::to_camera` from the difference on: mantissas of the view, and z in 64 bits, the upper 32 and the lower.
fn to_camera(builder: &mut Builder, widths: &Widths) -> [Value; 5] {
    let names = ["x", "y", "z"];
    let [x, y, z] = [0, 1, 2].map(|row| {
        let bits = Some(u32::from(widths.view));
        let high = |i: usize| Operand::Input(HIGH + i as u8);
        let mut terms: Vec<Term> = (0..3)
            .map(|i| product(high(i), constant(TURN[row][i])))
            .collect();
        if low_bits(widths) > 0 {
            let low = |i: usize| Operand::Input(LOW + i as u8);
            let tails = (0..3).map(|i| product(low(i), constant(TURN[row][i])));
            let rests = (0..3).map(|i| product(high(i), constant(REST[row][i])));
            terms[0].again = true;
            terms = tails.chain(rests).chain(terms).collect();
        }
        builder.add(names[row], terms, Unit::First(0), bits)
    });
    let [high, low] =
        [("z, high", 32), ("z, low", 0)].map(|(name, below)| builder.word(name, below));
    [x, y, z, high, low]
}

/// `rotate_axis` for the three axes.
fn turned_axes(builder: &mut Builder, bits: u32) -> [[Value; 3]; 3] {
    [0, 1, 2].map(|axis: u8| {
        [0, 1, 2].map(|row| {
            let entry = |i: usize| {
                let component = Operand::Input(AXES + 3 * axis + i as u8);
                product(component, constant(AXIS[row][i]))
            };
            let name = format!("axis {axis}, row {row}");
            let unit = Unit::First(61 - (bits + GUARD) as i32);
            builder.add(&name, cut((0..3).map(entry).collect()), unit, Some(bits))
        })
    })
}

struct ProjectedTerms {
    inverse: Value,
    position: [[Value; 2]; 2],
    ratio: [Value; 2],
    gain: [Value; 2],
}

/// `project`, whose culls are `setup_pack.sv`'s.
fn project(
    builder: &mut Builder,
    [x, y, z]: [Value; 3],
    view: u32,
    mantissa: u32,
) -> ProjectedTerms {
    const FOCAL: [&str; 2] = ["focal_u", "focal_v"];
    const PRINCIPAL: [[&str; 2]; 2] = [
        ["principal_u_high", "principal_u_low"],
        ["principal_v_high", "principal_v_low"],
    ];
    let inverse = builder.reciprocal("1/z", z, view);
    let inverse = builder.pick(
        "1/z or 1",
        Pick::Flag(PERSPECTIVE),
        inverse,
        constant("one"),
        None,
    );
    let on_plane = [x, y].map(|c| builder.multiply("on plane", value(c), value(inverse), view));
    let position = [0, 1].map(|axis| {
        let [high, low] = PRINCIPAL[axis].map(|part| plain(constant(part)));
        let offset = product(value(on_plane[axis]), constant(FOCAL[axis]));
        let terms = vec![high, low, offset];
        let high = builder.add("position, high", terms, Unit::At(-32), None);
        [builder.from(high, 32), builder.word("position, low", 0)]
    });
    let gain =
        FOCAL.map(|focal| builder.multiply("gain", value(inverse), constant(focal), mantissa));
    let ratio = [0, 1].map(|axis| ratio(builder, on_plane[axis], axis, mantissa));
    ProjectedTerms {
        inverse,
        position,
        ratio,
        gain,
    }
}

/// `ratios` of one axis. Without a clamp the limits are the format's ends, and orthographic views have limits of 0.
fn ratio(builder: &mut Builder, on_plane: Value, axis: usize, bits: u32) -> Value {
    const LOW: [&str; 2] = ["below_u", "below_v"];
    const HIGH: [&str; 2] = ["above_u", "above_v"];
    const FIRST: [&str; 2] = ["least_u", "least_v"];
    const LAST: [&str; 2] = ["most_u", "most_v"];
    let over_low = vec![plain(value(on_plane))];
    let over_low = builder.add_to("above the least ratio", LOW[axis], over_low, Unit::At(-32));
    let under_high = vec![taken_off(plain(value(on_plane)))];
    let under_high = builder.add_to(
        "below the largest ratio",
        HIGH[axis],
        under_high,
        Unit::At(-32),
    );
    let [over_low, under_high] = [over_low, under_high].map(|side| builder.from(side, 32));
    let free = builder.round("ratio", value(on_plane), bits);
    let low = builder.pick(
        "ratio, from below",
        Pick::Negative,
        over_low,
        value(free),
        Some(FIRST[axis]),
    );
    builder.pick(
        "ratio, from above",
        Pick::Negative,
        under_high,
        value(low),
        Some(LAST[axis]),
    )
}

/// `project_axes` from the turned axes on.
fn shear(
    builder: &mut Builder,
    turned: &[[Value; 3]; 3],
    projected: &ProjectedTerms,
    bits: u32,
) -> [[Value; 2]; 3] {
    turned.map(|[x, y, z]| {
        [0, 1].map(|axis| {
            let along = less(product(value(projected.ratio[axis]), value(z)));
            let sheared = vec![plain(value([x, y][axis])), along];
            let sheared = builder.sum("sheared", sheared, bits);
            builder.multiply("column", value(sheared), value(projected.gain[axis]), bits)
        })
    })
}

struct Covariance {
    xx: Value,
    xy: Value,
    yy: Value,
    determinant: Value,
    minors: [Value; 3],
}

/// `covariance`.
fn covariance(builder: &mut Builder, columns: &[[Value; 2]; 3], bits: u32) -> Covariance {
    let products = |i: usize, j: usize| {
        let each = columns.iter().map(|c| product(value(c[i]), value(c[j])));
        each.collect::<Vec<Term>>()
    };
    let low_pass = plain(constant("low_pass"));
    let xx = [products(0, 0), vec![low_pass]].concat();
    let xx = builder.sum("xx", xx, bits);
    let sharp = builder.sum("yy, sharp", products(1, 1), bits);
    let xy = builder.sum("xy", products(0, 1), bits);
    let yy = builder.sum("yy", vec![plain(value(sharp)), low_pass], bits);
    let trace = builder.sum("trace", vec![plain(value(xx)), plain(value(sharp))], bits);
    let minors = [(0, 1), (0, 2), (1, 2)].map(|(j, k)| {
        let [j, k] = [columns[j], columns[k]];
        let crossed = less(product(value(j[1]), value(k[0])));
        let minor = vec![product(value(j[0]), value(k[1])), crossed];
        builder.sum("minor", minor, bits)
    });
    let mut determinant = squares(&minors);
    determinant.push(product(value(trace), constant("low_pass")));
    let determinant = builder.sum("determinant", determinant, bits);
    Covariance {
        xx,
        xy,
        yy,
        determinant,
        minors,
    }
}

fn squares(values: &[Value]) -> Vec<Term> {
    let square = |v: &Value| product(value(*v), value(*v));
    values.iter().map(square).collect()
}

/// `compensate`. Where no area is left the weight is below every opacity.
fn compensate(
    builder: &mut Builder,
    weight: Value,
    covariance: &Covariance,
    inverse: Value,
    bits: u32,
) -> Value {
    let sharp = builder.sum("sharp determinant", squares(&covariance.minors), bits);
    let kept = builder.multiply("kept", value(sharp), value(inverse), bits);
    let twice = square_root(builder, "kept, root", kept, bits);
    // Exact: the root's half.
    let root = builder.multiply("kept, root", value(twice), constant("one_half"), bits);
    builder.multiply("weight, compensated", value(weight), value(root), bits)
}

/// Twice `square_root`.
fn square_root(builder: &mut Builder, name: &str, squared: Value, bits: u32) -> Value {
    let seed = builder.root(&format!("{name}, seed"), squared, 31);
    let inverse = builder.reciprocal(&format!("1/{name}"), seed, 31);
    let quotient = product(value(squared), value(inverse));
    builder.heron(&format!("{name}, twice"), seed, quotient, bits)
}

struct TermShape {
    horizontal: Value,
    squared_width: Value,
    shear: Value,
    vertical: Value,
    cross: Value,
    conic_c: Value,
    inverse: Value,
}

/// `ldl`, and the products of `conic`, which `setup_pack.sv` aligns.
fn shape(builder: &mut Builder, covariance: &Covariance, bits: u32) -> TermShape {
    let vertical = builder.reciprocal("1/yy", covariance.yy, bits);
    let inverse = builder.reciprocal("1/determinant", covariance.determinant, bits);
    let mut multiply = |name, a, b| builder.multiply(name, value(a), value(b), bits);
    TermShape {
        horizontal: multiply("horizontal", covariance.yy, inverse),
        squared_width: multiply("squared_width", covariance.determinant, vertical),
        shear: multiply("shear", covariance.xy, vertical),
        cross: multiply("cross", covariance.xy, inverse),
        conic_c: multiply("conic c", covariance.xx, inverse),
        vertical,
        inverse,
    }
}

/// `centre_opacity` of normalised kernels. The root's half stands in the constant `inverse_integral`.
fn peak(
    builder: &mut Builder,
    weight: Value,
    projected: &ProjectedTerms,
    inverse: Value,
    bits: u32,
) -> Value {
    let slant = [vec![plain(constant("one"))], squares(&projected.ratio)].concat();
    let slant = builder.sum("slant", slant, bits);
    let squared = builder.multiply("density squared", value(slant), value(inverse), bits);
    let density = square_root(builder, "density", squared, bits);
    let [gain_u, gain_v] = projected.gain;
    let area = builder.multiply("area", value(gain_u), value(gain_v), bits);
    let peak = builder.multiply("weight of the area", value(weight), value(area), bits);
    let peak = builder.multiply("peak of the profile", value(peak), value(density), bits);
    let integral = constant("inverse_integral");
    builder.multiply("peak, normalised", value(peak), integral, bits)
}

/// `cutoff` and the logarithm that it follows from.
fn cutoff(builder: &mut Builder, peak: Value) -> Value {
    let whole = builder.round("peak, 31 bits", value(peak), 31);
    let [entry, step] = [0, 1].map(|i| Builder::looked_up(Table::Logarithm, whole)[i]);
    let rest = builder.add_to("rest", "logarithm_one", vec![step], Unit::At(-36));
    let by = |inner: Operand| taken_off(product(value(rest), inner));
    let fifth = vec![plain(constant("quarter")), by(constant("fifth"))];
    let fifth = builder.add("1/4 - d/5", fifth, Unit::At(-30), None);
    let fourth = builder.add_to(
        "1/3 - d (1/4 ..)",
        "third",
        vec![by(value(fifth))],
        Unit::At(-30),
    );
    let third = builder.add_to(
        "1/2 - d (1/3 ..)",
        "half",
        vec![by(value(fourth))],
        Unit::At(-30),
    );
    let bent = vec![product(value(rest), value(third))];
    let bent = builder.add("d (1/2 ..)", bent, Unit::At(-36), None);
    let power = |half| Term {
        power: true,
        ..product(value(whole), constant(half))
    };
    let logarithm = vec![
        entry,
        power("ln_2_high"),
        power("ln_2_low"),
        plain(value(rest)),
        by(value(bent)),
    ];
    // Twice the difference to the logarithm of the least opacity, and its roundings, from the same sum.
    let cutoff = builder.add_to("cut-off, unlimited", "ln_least", logarithm, Unit::At(-40));
    let cutoff = builder.from(cutoff, 11);
    let above = builder.word("above 0", 32);
    let end = taken_off(plain(constant("logarithm_end")));
    let beyond = builder.further("beyond the end", end, 32);
    let nothing = Some("nothing");
    let cutoff = builder.pick(
        "cut-off above 0",
        Pick::Negative,
        above,
        value(cutoff),
        nothing,
    );
    let cutoff = builder.pick(
        "cut-off, limited",
        Pick::NotNegative,
        beyond,
        value(cutoff),
        Some("cutoff_end"),
    );
    let given = constant("cutoff");
    builder.pick("cut-off", Pick::Flag(BY_OPACITY), cutoff, given, None)
}

/// The roots of `bounding_box`; the rest of it is `setup_pack.sv`'s.
fn extents(builder: &mut Builder, cutoff: Value, covariance: &Covariance) -> [Value; 2] {
    let doubled = Term {
        doubled: true,
        ..plain(value(cutoff))
    };
    let cutoff = builder.add("cut-off, 16 bits", vec![doubled], Unit::First(0), Some(16));
    [covariance.xx, covariance.yy].map(|variance| {
        let squared = builder.multiply("extent squared", value(cutoff), value(variance), 16);
        builder.root("extent", squared, 16)
    })
}

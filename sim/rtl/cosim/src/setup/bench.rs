//! Splats through the setup unit, with random pauses at both ends, every packet and every reason against the kernel's.

use super::constants::constants;
use super::model::{RECORD, SetupInputs, SetupModel, SetupOutputs};
use super::program::SetupProgram;
use crate::workload::split_mix;
use anyhow::{Result, ensure};
use splatline::footprint::Footprint;
use splatline::footprint::packet::{Layout, Packet};
use splatline::format::{Design, RuntimeWidths, Widths};
use splatline::math::SoftFloat;
use splatline::rules::Rules;
use splatline::setup::{Cull, setup};
use splatline::splat::VolumeSplat;
use splatline::view::View;

/// What is set up: splats seen by a camera under rules.
#[derive(Clone, Debug)]
pub struct SetupLoad {
    /// What it is.
    pub name: String,
    /// The camera.
    pub view: View,
    /// The rules.
    pub rules: Rules,
    /// The splats.
    pub splats: Vec<VolumeSplat>,
}

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct SetupFindings {
    /// Splats whose packet or reason was compared.
    pub splats: usize,
    /// Of them culled, by reason as in `Cull::ALL`.
    pub culled: [usize; 6],
    /// Of them with another packet or reason than the kernel's.
    pub mismatches: usize,
    /// The first of those.
    pub first_difference: Option<String>,
    /// Splats with an exponent that has no place in a record: not offered.
    pub unfit: usize,
    /// Cycles.
    pub cycles: u64,
}

impl SetupLoad {
    /// The same view and rules.
    pub fn clone_without_splats(&self) -> SetupLoad {
        SetupLoad {
            name: self.name.clone(),
            view: self.view,
            rules: self.rules,
            splats: Vec::new(),
        }
    }
}

impl SetupFindings {
    /// Both together.
    pub fn and(&self, other: &SetupFindings) -> SetupFindings {
        let difference = self
            .first_difference
            .as_ref()
            .or(other.first_difference.as_ref());
        let mut culled = self.culled;
        for (sum, more) in culled.iter_mut().zip(other.culled) {
            *sum += more;
        }
        SetupFindings {
            splats: self.splats + other.splats,
            culled,
            mismatches: self.mismatches + other.mismatches,
            first_difference: difference.cloned(),
            unfit: self.unfit + other.unfit,
            cycles: self.cycles + other.cycles,
        }
    }
}

/// Cycles without a packet after which the unit counts as hanging.
const PATIENCE: u32 = 20_000;

/// Pauses of packets from here on last for blocks of cycles.
pub const LONG: u64 = 8;
const BLOCK: u64 = 2_048;

/// A splat as the unit takes it; nothing if an exponent has no place.
pub fn record(splat: &VolumeSplat) -> Option<[u32; RECORD]> {
    let mut bits = RecordBits::default();
    for coordinate in splat.centre {
        bits.put(coordinate.mantissa as u32, 32);
    }
    for coordinate in splat.centre {
        bits.put(exponent(coordinate.exponent, coordinate.mantissa == 0)?, 10);
    }
    for axis in splat.axes {
        for component in axis.mantissa {
            bits.put(component as u32, 32);
        }
    }
    for axis in splat.axes {
        bits.put(exponent(axis.exponent, axis.mantissa == [0; 3])?, 10);
    }
    bits.put(splat.weight.mantissa as u32, 32);
    bits.put(
        exponent(splat.weight.exponent, splat.weight.mantissa == 0)?,
        10,
    );
    for channel in splat.colour {
        bits.put(channel.to_bits(), 32);
    }
    Some(bits.words)
}

/// Ten bits; 0 has any exponent.
fn exponent(value: i32, zero: bool) -> Option<u32> {
    match value {
        _ if zero => Some(0),
        -512..=511 => Some(value as u32 & 0x3ff),
        _ => None,
    }
}

#[derive(Default)]
struct RecordBits {
    words: [u32; RECORD],
    filled: usize,
}

impl RecordBits {
    fn put(&mut self, value: u32, bits: usize) {
        let placed = u64::from(value) << (self.filled % 32);
        let word = self.filled / 32;
        self.words[word] |= placed as u32;
        if let Some(next) = self.words.get_mut(word + 1) {
            *next |= (placed >> 32) as u32;
        }
        self.filled += bits;
    }
}

/// What the kernel says: the packet's words, or the reason.
fn expected(
    design: RuntimeWidths,
    layout: &Layout,
    load: &SetupLoad,
    splat: &VolumeSplat,
) -> Result<Packet, Cull> {
    setup(design, &load.view, &load.rules, splat).map(|footprint| layout.encode(&footprint))
}

fn reason(cull: Cull) -> u8 {
    Cull::ALL
        .iter()
        .position(|known| *known == cull)
        .map_or(0, |i| i as u8 + 1)
}

/// Draws `load` through the circuit, whose cores have this program. `pauses`: how many of 8 cycles, at random, hold a record or a packet back; from [`LONG`] on packets are not taken at
/// all for thousands of cycles, until every queue is full.
pub fn run(
    model: &mut SetupModel,
    design: RuntimeWidths,
    program: SetupProgram,
    load: &SetupLoad,
    pauses: u64,
) -> Result<SetupFindings> {
    let widths = design.widths();
    let layout = Layout::new(&widths);
    write_constants(model, &program(&widths)?.constants, &widths, load)?;
    let mut findings = SetupFindings::default();
    let splats: Vec<(&VolumeSplat, [u32; RECORD])> = load
        .splats
        .iter()
        .filter_map(|s| Some((s, record(s)?)))
        .collect();
    findings.unfit = load.splats.len() - splats.len();
    let (mut offered, mut state, mut idle) = (0, 7, 0);
    while findings.splats < splats.len() {
        let held = split_mix(&mut state);
        let inputs = SetupInputs {
            record_valid: (offered < splats.len() && held % 8 >= pauses % LONG).into(),
            record: splats
                .get(offered)
                .map_or([0; RECORD], |(_, record)| *record),
            packet_ready: taken(&findings, held >> 8, pauses).into(),
            ..SetupInputs::default()
        };
        let out = model.tick(&inputs);
        findings.cycles += 1;
        offered += usize::from(inputs.record_valid & out.record_ready);
        idle += 1;
        ensure!(
            idle < PATIENCE,
            "{}: the setup unit hangs after {} splats",
            load.name,
            findings.splats
        );
        if inputs.packet_ready & out.packet_valid == 1 {
            let splat = splats[findings.splats].0;
            compare(
                &mut findings,
                &expected(design, &layout, load, splat),
                &out,
                &layout,
            );
            idle = 0;
        }
    }
    Ok(findings)
}

fn taken(findings: &SetupFindings, held: u64, pauses: u64) -> bool {
    let mut block = findings.cycles / BLOCK;
    held % 8 >= pauses % LONG && (pauses < LONG || split_mix(&mut block).is_multiple_of(2))
}

/// Writes the constants that a program asks for, by their names.
pub fn write_constants(
    model: &mut SetupModel,
    names: &[&'static str],
    widths: &Widths,
    load: &SetupLoad,
) -> Result<()> {
    for (index, value, exponent) in constants(names, widths, &load.view, &load.rules)? {
        model.tick(&SetupInputs {
            constant_valid: 1,
            constant_index: index,
            constant_value: value as u64,
            constant_exponent: exponent as u32,
            ..SetupInputs::default()
        });
    }
    Ok(())
}

fn compare(
    findings: &mut SetupFindings,
    expected: &Result<Packet, Cull>,
    out: &SetupOutputs,
    layout: &Layout,
) {
    let index = findings.splats;
    findings.splats += 1;
    let same = match expected {
        Ok(packet) => out.cull == 0 && out.packet[..layout.words()] == packet[..layout.words()],
        Err(cull) => {
            let reason = reason(*cull);
            findings.culled[usize::from(reason) - 1] += 1;
            out.cull == reason
        }
    };
    if same {
        return;
    }
    findings.mismatches += 1;
    if findings.first_difference.is_none() {
        let words = match (expected, out.cull) {
            (Ok(packet), 0) => match (layout.decode(packet), layout.decode(&out.packet)) {
                (Ok(wanted), Ok(got)) => in_words(&wanted, &got),
                (_, got) => format!("a packet that decodes to {got:?}"),
            },
            (Ok(_), cull) => format!("culled: {:?}", known(cull)),
            (Err(cull), 0) => format!("not culled: {cull:?}"),
            (Err(cull), other) => format!("{:?}, not {cull:?}", known(other)),
        };
        findings.first_difference = Some(format!("splat {index}: {words}"));
    }
}

fn known(reason: u8) -> Option<Cull> {
    Cull::ALL.get(usize::from(reason).wrapping_sub(1)).copied()
}

/// The first field that is another one, with both values, and the names of the others.
fn in_words(wanted: &Footprint, got: &Footprint) -> String {
    let number = |x: SoftFloat| format!("{} * 2^{}", x.mantissa, x.exponent);
    let fields = |f: &Footprint| {
        [
            ("depth", f.depth.to_string()),
            ("centre", format!("{:?}", f.centre)),
            ("horizontal", number(f.ldl.horizontal)),
            ("squared width", number(f.ldl.squared_width)),
            ("shear", number(f.ldl.shear)),
            ("vertical", number(f.ldl.vertical)),
            (
                "conic",
                format!("{:?} * 2^{}", f.conic.mantissa, f.conic.exponent),
            ),
            ("cut-off", f.cutoff.to_string()),
            ("opacity", f.opacity.to_string()),
            ("colour", format!("{:?}", f.colour)),
            ("first", format!("{:?}", f.first)),
            ("end", format!("{:?}", f.end)),
        ]
    };
    let (wanted, got) = (fields(wanted), fields(got));
    let mut differ = wanted
        .iter()
        .zip(&got)
        .filter(|(wanted, got)| wanted != got);
    let Some(((name, wanted), (_, got))) = differ.next() else {
        return "the same fields in other bits".to_owned();
    };
    let others: Vec<&str> = differ.map(|(wanted, _)| wanted.0).collect();
    let others = match others.as_slice() {
        [] => String::new(),
        others => format!("; and {}", others.join(", ")),
    };
    format!("{name} {got}, not {wanted}{others}")
}

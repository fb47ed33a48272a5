//! The setup unit against the kernel's `setup`: every packet and every reason of a cull, with back-pressure at both
//! ends.

use super::constants::{Constant, constants};
use super::exact::exact;
use super::loads::{SetupLoad, captured, distant, synthetic};
use super::program::{ProgramKind, SetupProgram};
use super::record::record;
use super::tables;
use crate::bench::{Bench, Channels, Checker, Item, Pressure};
use crate::circuit::SETUP;
use crate::simulation::{Port, Simulation};
use crate::unit::{Circuit, Extent, Findings, Load, Loads, Missing, in_parts};
use anyhow::Result;
use splatline::footprint::Footprint;
use splatline::footprint::packet::{Layout, Packet};
use splatline::format::{RuntimeWidths, Traversal};
use splatline::math::SoftFloat;
use splatline::setup::harmonics::direction;
use splatline::setup::{Cull, setup};
use splatline::splat::VolumeSplat;
use splatline_sim::scene::synthetic::Random;

/// At full speed; with packets that are not taken for thousands of cycles, until every queue is full; with pauses at
/// both ends.
const PRESSURES: [Pressure; 3] = [
    Pressure::at_ends([0; 3]),
    Pressure {
        stalls: 2_048,
        ..Pressure::at_ends([0; 3])
    },
    Pressure::at_ends([96; 3]),
];

/// The names of culls as in [`Cull::ALL`].
const CULLS: [&str; Cull::ALL.len()] = [
    "near",
    "far",
    "range",
    "degenerate",
    "transparent",
    "outside",
];

/// The unit of a design with some cores and this program.
pub fn circuit(design: &str, cores: u32, program: SetupProgram) -> Result<Circuit> {
    Ok(Circuit::new(&SETUP, design, cores)?.with_program(program))
}

/// Splats of one part of a load.
const PART: usize = 10_000;

impl Load for SetupLoad {
    /// What the units of the tables are given does not depend on when it comes.
    fn pressures(circuit: &Circuit) -> usize {
        match circuit.program.kind {
            ProgramKind::Units => 1,
            _ => PRESSURES.len(),
        }
    }

    fn all(circuit: &Circuit, extent: Extent, missing: &mut Missing) -> Result<Loads<SetupLoad>> {
        let (widths, kind) = (&circuit.design.widths, circuit.program.kind);
        let (far, [few, many], step) = match extent {
            Extent::Quick => (300, [300, 400], 400),
            Extent::Full => (4_000, [12_000; 2], 1),
        };
        let mut loads = match kind {
            ProgramKind::Units => return Ok(tables::arguments(widths.mantissa, extent)),
            ProgramKind::DistanceScaling => distant(far, 1),
            // The quickest to show a mutation first.
            ProgramKind::Filter | ProgramKind::Compensation => [
                exact(widths, few, 1),
                synthetic(many, 1),
                captured(step, missing)?,
            ]
            .concat(),
        };
        for (_, load) in &mut loads {
            load.rules.compensated = kind == ProgramKind::Compensation;
        }
        let parts = loads.iter().map(|(name, load)| {
            let part = |splats: &[VolumeSplat]| SetupLoad {
                splats: splats.to_vec(),
                ..*load
            };
            in_parts(name, &load.splats, PART, part)
        });
        Ok(parts.flatten().collect())
    }

    fn compare(&self, circuit: &Circuit, mut bench: Bench, pressure: usize) -> Result<Findings> {
        bench.random = Random(7);
        let words = constants(circuit, &self.view, &self.rules)?;
        write_constants(&mut bench, &words)?;
        let widths = &circuit.design.widths;
        let mut checker = SetupChecker {
            circuit,
            design: circuit.design.in_fields(),
            layout: Layout::new(widths, Traversal::Spans),
            load: self,
            offered: Vec::new(),
            direction_ports: None,
            directions: 0,
            culled: [0; 6],
        };
        if circuit.program.directs {
            let ports = ["direction_valid", "direction_seen", "direction"];
            checker.direction_ports = Some(bench.circuit.ports(ports)?);
        }
        let mut items = Vec::new();
        for splat in &self.splats {
            // One whose exponents have no place in a record is not offered.
            if let Some(record) = record(splat) {
                items.push(Item {
                    lanes: vec![vec![(0, vec![record.to_vec()])]],
                    answers: 1,
                });
                checker.offered.push(splat);
            }
        }
        // Records in, packets or reasons out.
        let sink: (_, &[_]) = ("packet", &["cull", "depth", "packet"]);
        let channels = Channels::new(&bench.circuit, &[("record", &["record"])], sink)?;
        let mut findings = bench.run(&channels, &items, &PRESSURES[pressure], &mut checker)?;
        let directions = checker.directions;
        if checker.direction_ports.is_some() && directions != items.len() {
            let few = || format!("{directions} directions");
            findings.first_difference.get_or_insert_with(few);
        }
        if circuit.program.kind != ProgramKind::Units {
            findings.counts = CULLS.into_iter().zip(checker.culled).collect();
        }
        Ok(findings)
    }
}

/// Writes constants for the cores and the registers beside them.
pub fn write_constants(bench: &mut Bench, words: &[Constant]) -> Result<()> {
    for (index, value, exponent) in words {
        bench.set(&[
            ("constant_valid", 1),
            ("constant_index", (*index).into()),
            ("constant_value", *value as u64),
            ("constant_exponent", *exponent as u64),
        ])?;
        bench.cycle();
    }
    bench.set(&[("constant_valid", 0)])
}

struct SetupChecker<'a> {
    circuit: &'a Circuit,
    design: RuntimeWidths,
    layout: Layout,
    load: &'a SetupLoad,
    offered: Vec<&'a VolumeSplat>,
    /// Valid, seen and the direction, if the program gives any: each comes once and at its own time.
    direction_ports: Option<[Port; 3]>,
    /// How many have come.
    directions: usize,
    culled: [u64; 6],
}

impl Checker for SetupChecker<'_> {
    fn observe(&mut self, circuit: &Simulation, _: &Channels, _: u64) -> Option<String> {
        let [valid, seen_port, port] = self.direction_ports?;
        if !circuit.is(valid) {
            return None;
        }
        let number = self.directions;
        self.directions += 1;
        let Some(splat) = self.offered.get(number) else {
            return Some("a direction too many".to_owned());
        };
        let SetupLoad { view, rules, .. } = self.load;
        let wanted = direction(&self.circuit.design.widths, view, &splat.centre);
        let wanted = wanted.map(|axis| axis.to_bits() as u32);
        let seen = setup(self.design, view, rules, splat).is_ok();
        let got = circuit.words(port);
        (got != wanted || circuit.is(seen_port) != seen)
            .then(|| format!("splat {number}: direction {got:x?}, not {wanted:x?}; seen: {seen}"))
    }

    fn check(&mut self, number: usize, answer: &[Vec<u32>]) -> Option<String> {
        let SetupLoad { view, rules, .. } = self.load;
        let splat = self.offered[number];
        let mut got = Packet::default();
        got[..answer[2].len()].copy_from_slice(&answer[2]);
        if self.circuit.program.kind == ProgramKind::Units {
            let Ok(got) = self.layout.decode(&got) else {
                return Some("a packet of another version".to_owned());
            };
            return tables::difference(&self.circuit.design.widths, splat.weight, &got);
        }
        let expected = setup(self.design, view, rules, splat);
        if let Err(cull) = &expected {
            self.culled[cull.place()] += 1;
        }
        let known = |reason: u32| Cull::ALL.get((reason as usize).wrapping_sub(1)).copied();
        let reason = answer[0][0];
        let depth = u64::from(answer[1][0]) | u64::from(answer[1][1]) << 32;
        let words = match (expected, reason) {
            (Ok(wanted), 0) => {
                let length = self.layout.words();
                if depth == wanted.depth && self.layout.encode(&wanted)[..length] == got[..length] {
                    return None;
                }
                match self.layout.decode(&got) {
                    Ok(got) => in_words(&wanted, &Footprint { depth, ..got }),
                    Err(error) => format!("no packet: {error:?}"),
                }
            }
            (Ok(_), reason) => format!("culled: {:?}", known(reason)),
            (Err(cull), reason) if known(reason) == Some(cull) => return None,
            (Err(cull), reason) => format!("{:?}, not {cull:?}", known(reason)),
        };
        Some(format!("splat {number}: {words}"))
    }
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
            ("cut-off", f.cutoff.to_string()),
            ("opacity", f.opacity.to_string()),
            ("colour", format!("{:?}", f.colour)),
            ("first", format!("{:?}", f.first)),
            ("end", format!("{:?}", f.end)),
        ]
    };
    let (wanted, got) = (fields(wanted), fields(got));
    let pairs = wanted.iter().zip(&got);
    let differ = pairs.filter(|(wanted, got)| wanted != got);
    let words = differ.map(|((name, wanted), (_, got))| format!("{name} {got}, not {wanted}"));
    words.collect::<Vec<_>>().join("; ")
}

//! The setup unit against the kernel's `setup`: every packet and every reason of a cull, with back-pressure at both
//! ends.

use super::constants::{Constant, constants};
use super::exact::exact;
use super::loads::{RECORD, SetupLoad, captured, distant, record, synthetic};
use super::program::{ProgramKind, SetupProgram};
use super::tables;
use crate::bench::{Bench, Channels, Item, Pressure};
use crate::circuit::SETUP;
use crate::simulation::Simulation;
use crate::unit::{Circuit, Extent, Findings, Load, Loads, Missing};
use anyhow::Result;
use splatline::footprint::Footprint;
use splatline::footprint::packet::{Layout, Packet};
use splatline::format::Traversal;
use splatline::math::SoftFloat;
use splatline::setup::harmonics::direction;
use splatline::setup::{Cull, setup};
use splatline::splat::VolumeSplat;

/// At full speed; with packets that are not taken for thousands of cycles, until every queue is full; with pauses at
/// both ends.
const PRESSURES: [Pressure; 3] = [
    Pressure::new([0; 3], 0, 0),
    Pressure::new([0; 3], 2_048, 0),
    Pressure::new([96; 3], 0, 0),
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
    const WAYS: usize = PRESSURES.len();

    fn all(circuit: &Circuit, extent: Extent, missing: &mut Missing) -> Result<Loads<SetupLoad>> {
        let (widths, kind) = (&circuit.design.widths, circuit.program.kind);
        let [far, few, many] = extent.of([300, 300, 400], [4_000, 12_000, 12_000]);
        let mut loads = match kind {
            ProgramKind::Units => return Ok(tables::arguments(widths.mantissa, extent)),
            ProgramKind::DistanceScaling => distant(far),
            // The quickest to show a mutation first.
            ProgramKind::Filter | ProgramKind::Compensation => [
                exact(widths, few),
                synthetic(many, 1),
                captured(extent.of(400, 1), missing)?,
            ]
            .concat(),
        };
        for (_, load) in &mut loads {
            load.rules.compensated = kind == ProgramKind::Compensation;
        }
        let parts = loads.iter().flat_map(|(name, load)| {
            let part = |splats: &[VolumeSplat]| SetupLoad {
                splats: splats.to_vec(),
                ..*load
            };
            let parts = load.splats.chunks(PART);
            parts.map(move |splats| (name.clone(), part(splats)))
        });
        Ok(parts.collect())
    }

    fn compare(&self, circuit: &Circuit, mut bench: Bench, pressure: usize) -> Result<Findings> {
        // What the units of the tables are given does not depend on when it comes.
        if circuit.program.kind == ProgramKind::Units && pressure > 0 {
            return Ok(Findings::default());
        }
        let words = constants(circuit, &self.view, &self.rules)?;
        write_constants(&mut bench, &words);
        // One whose exponents have no place in a record is not offered.
        let splats = self.splats.iter();
        let offered: Vec<_> = splats
            .filter_map(|splat| Some((splat, record(splat)?)))
            .collect();
        let item = |record: &[u32]| Item {
            lanes: vec![vec![(0, vec![record[..RECORD].to_vec()])]],
            answers: 1,
        };
        let items: Vec<Item> = offered.iter().map(|(_, record)| item(record)).collect();
        // Records in, packets or reasons out.
        let sink: (_, &[_]) = ("packet", &["cull", "depth", "packet"]);
        let channels = Channels::new(&bench.circuit, &[("record", &["record"])], sink);
        let layout = Layout::new(&circuit.design.widths, Traversal::Spans);
        let directs = circuit.program.directs;
        let (mut culled, mut directions) = ([0; CULLS.len()], 0);
        let check = |number: usize, answer: &[Vec<u32>]| {
            let (splat, _) = offered[number];
            let words = self.answer_difference(circuit, &layout, splat, answer, &mut culled)?;
            Some(format!("splat {number}: {words}"))
        };
        // Each direction comes once and at its own time.
        let observe = |simulation: &Simulation, _: &Channels, _: u64| {
            if !directs || simulation.read("direction_valid") == 0 {
                return None;
            }
            let number = directions;
            directions += 1;
            let Some((splat, _)) = offered.get(number) else {
                return Some("a direction too many".to_owned());
            };
            let words = self.direction_difference(circuit, splat, simulation)?;
            Some(format!("splat {number}: {words}"))
        };
        let pressure = &PRESSURES[pressure];
        let mut findings = bench.run(&channels, &items, pressure, check, observe)?;
        if directs && directions != items.len() {
            let few = || format!("{directions} directions");
            findings.first_difference.get_or_insert_with(few);
        }
        if circuit.program.kind != ProgramKind::Units {
            findings.counts = CULLS.into_iter().zip(culled).collect();
        }
        Ok(findings)
    }
}

/// Writes constants for the cores and the registers beside them.
pub fn write_constants(bench: &mut Bench, words: &[Constant]) {
    for (index, value, exponent) in words {
        bench.set(&[
            ("constant_valid", 1),
            ("constant_index", (*index).into()),
            ("constant_value", *value as u64),
            ("constant_exponent", *exponent as u64),
        ]);
        bench.cycle();
    }
    bench.set(&[("constant_valid", 0)]);
}

impl SetupLoad {
    /// What the answer to a splat has that is not the kernel's; counts its reason if it is culled.
    fn answer_difference(
        &self,
        circuit: &Circuit,
        layout: &Layout,
        splat: &VolumeSplat,
        answer: &[Vec<u32>],
        culled: &mut [u64; CULLS.len()],
    ) -> Option<String> {
        let mut packet = Packet::default();
        packet[..answer[2].len()].copy_from_slice(&answer[2]);
        if circuit.program.kind == ProgramKind::Units {
            return tables::difference(&circuit.design.widths, splat.weight, layout, &packet);
        }
        let expected = setup(circuit.design.in_fields(), &self.view, &self.rules, splat);
        if let Err(cull) = &expected {
            culled[cull.place()] += 1;
        }
        difference(layout, expected, answer, &packet)
    }

    /// What a direction that comes, and whether its splat is seen, have that the kernel has not.
    fn direction_difference(
        &self,
        circuit: &Circuit,
        splat: &VolumeSplat,
        simulation: &Simulation,
    ) -> Option<String> {
        let SetupLoad { view, rules, .. } = self;
        let wanted = direction(&circuit.design.widths, view, &splat.centre);
        let wanted = wanted.map(|axis| axis.to_bits() as u32);
        let seen = setup(circuit.design.in_fields(), view, rules, splat).is_ok();
        let got = simulation.words(simulation.port("direction"));
        (got != wanted || simulation.read("direction_seen") != u64::from(seen))
            .then(|| format!("direction {got:x?}, not {wanted:x?}; seen: {seen}"))
    }
}

/// What an answer and its packet have that is not expected.
fn difference(
    layout: &Layout,
    expected: Result<Footprint, Cull>,
    answer: &[Vec<u32>],
    packet: &Packet,
) -> Option<String> {
    let known = |reason: u32| Cull::ALL.get((reason as usize).wrapping_sub(1)).copied();
    let depth = u64::from(answer[1][0]) | u64::from(answer[1][1]) << 32;
    match (expected, answer[0][0]) {
        (Ok(wanted), 0) => match layout.decode(packet) {
            _ if depth == wanted.depth && layout.encode(&wanted) == *packet => None,
            Ok(got) => Some(in_words(&wanted, &Footprint { depth, ..got })),
            Err(error) => Some(format!("no packet: {error:?}")),
        },
        (Ok(_), reason) => Some(format!("culled: {:?}", known(reason))),
        (Err(cull), reason) if known(reason) == Some(cull) => None,
        (Err(cull), reason) => Some(format!("{:?}, not {cull:?}", known(reason))),
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

//! The setup unit against the kernel's `setup`: every packet and every reason of a cull, with back-pressure at both ends.

use super::constants::{Constant, constants, turned_back};
use super::distant::distant;
use super::exact::exact;
use super::loads::{captured, synthetic};
use super::program::{ProgramKind, SetupProgram};
use super::record::record;
use crate::bench::{Bench, Channel, Channels, Checker, Item, Offer, Pressure};
use crate::circuit::{Circuit, SETUP};
use crate::findings::Findings;
use crate::simulation::{Port, Simulation};
use crate::unit::{Extent, Unit};
use anyhow::{Context, Result};
use splatline::footprint::Footprint;
use splatline::footprint::packet::{Layout, Packet};
use splatline::format::{RuntimeWidths, Traversal, Widths};
use splatline::math::SoftFloat;
use splatline::rules::Rules;
use splatline::setup::harmonics::direction;
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

/// At full speed; with packets that are not taken for thousands of cycles, until every queue is full; with pauses at both ends.
const PRESSURES: [Pressure; 3] = [
    PAUSES[0],
    Pressure {
        stalls: 2_048,
        ..PAUSES[0]
    },
    PAUSES[1],
];

const PAUSES: [Pressure; 2] = [at_both_ends(0), at_both_ends(96)];

const fn at_both_ends(share: u8) -> Pressure {
    Pressure {
        offers: [share; 2],
        answers: share,
        inside: 0,
        stalls: 0,
        resets: 0,
        retracts: true,
    }
}

/// The names of culls as in [`Cull::ALL`].
const CULLS: [&str; 6] = [
    "near",
    "far",
    "range",
    "degenerate",
    "transparent",
    "outside",
];

/// The unit of a design with some cores.
pub struct SetupUnit {
    circuit: Circuit,
}

impl SetupUnit {
    /// With a program of a kind of setup.
    pub fn new(design: &str, cores: u32, kind: ProgramKind) -> Result<SetupUnit> {
        Self::with_program(design, cores, SetupProgram::new(kind))
    }

    /// With this program.
    pub fn with_program(design: &str, cores: u32, program: SetupProgram) -> Result<SetupUnit> {
        let circuit = Circuit::new(&SETUP, design, cores)?.with_program(program);
        Ok(SetupUnit { circuit })
    }
}

/// Splats of one part of a load.
const PART: usize = 10_000;

impl Unit for SetupUnit {
    type Load = SetupLoad;
    const COUNTS: &'static [&'static str] = &CULLS;
    const PRESSURES: usize = PRESSURES.len();

    fn circuit(&self) -> &Circuit {
        &self.circuit
    }

    fn loads(&self, extent: Extent, missing: &mut Vec<&'static str>) -> Result<Vec<SetupLoad>> {
        let (quick, kind) = (extent == Extent::Quick, self.circuit.program.kind);
        if kind == ProgramKind::DistanceScaling {
            let loads = distant(if quick { 300 } else { 4_000 }, 1);
            return Ok(loads.into_iter().flat_map(parts).collect());
        }
        // The quickest to show a mutation first.
        let [few, many, step] = if quick {
            [300, 400, 400]
        } else {
            [12_000, 12_000, 1]
        };
        let mut loads = [exact(few, 1), synthetic(many, 1), captured(step, missing)?].concat();
        for load in &mut loads {
            load.rules.compensated = kind == ProgramKind::Compensation;
        }
        Ok(loads.into_iter().flat_map(parts).collect())
    }

    fn name(&self, load: &SetupLoad) -> String {
        load.name.clone()
    }

    fn compare(&self, circuit: Simulation, load: &SetupLoad, pressure: usize) -> Result<Findings> {
        let mut bench = Bench::new(circuit, 7)?;
        write_constants(&mut bench, &self.circuit, &load.view, &load.rules)?;
        let design = RuntimeWidths::new(self.circuit.widths).ok();
        let mut checker = SetupChecker {
            design: design.context("widths out of range")?,
            layout: Layout::new(&self.circuit.widths, Traversal::Spans),
            load,
            offered: Vec::new(),
            directions: DirectionPorts::new(&bench.circuit, &self.circuit)?,
            culled: [0; 6],
        };
        let mut items = Vec::new();
        for splat in &load.splats {
            // One whose exponents have no place in a record is not offered.
            if let Some(record) = record(splat) {
                items.push(one_record(record.to_vec()));
                checker.offered.push(splat);
            }
        }
        let channels = channels(&bench.circuit)?;
        let mut findings = bench.run(&channels, &items, &PRESSURES[pressure], &mut checker)?;
        if let Some(ports) = &checker.directions {
            let few = (ports.came != items.len()).then(|| format!("{} directions", ports.came));
            findings.first_difference = findings.first_difference.or(few);
        }
        for (name, count) in CULLS.into_iter().zip(checker.culled) {
            findings.count(name, count);
        }
        Ok(findings)
    }
}

fn parts(load: SetupLoad) -> Vec<SetupLoad> {
    let part = |splats: &[VolumeSplat]| SetupLoad {
        name: load.name.clone(),
        splats: splats.to_vec(),
        ..load
    };
    load.splats.chunks(PART).map(part).collect()
}

/// Records in, packets or reasons out.
pub(super) fn channels(circuit: &Simulation) -> Result<Channels> {
    Ok(Channels {
        sources: vec![Channel::new(circuit, "record", &["record"])?],
        sink: Channel::new(circuit, "packet", &["cull", "depth", "packet"])?,
        enable: None,
    })
}

/// A record and its answer.
pub(super) fn one_record(record: Vec<u32>) -> Item {
    Item {
        lanes: vec![vec![Offer {
            source: 0,
            data: vec![record],
        }]],
        answers: 1,
    }
}

/// The words of a packet at the port.
pub(super) fn packet(words: &[u32]) -> Packet {
    let mut packet = Packet::default();
    packet[..words.len()].copy_from_slice(words);
    packet
}

/// The constants that the circuit's program asks for, by their names.
pub fn constant_words(circuit: &Circuit, view: &View, rules: &Rules) -> Result<Vec<Constant>> {
    let widths = &circuit.widths;
    let names = circuit.program.assembled(widths)?.constants;
    let mut words = constants(&names, widths, view, rules)?;
    if circuit.program.directs {
        words.extend(turned_back(view));
    }
    Ok(words)
}

/// Writes the constants of the circuit's program.
pub fn write_constants(
    bench: &mut Bench,
    circuit: &Circuit,
    view: &View,
    rules: &Rules,
) -> Result<()> {
    for (index, value, exponent) in constant_words(circuit, view, rules)? {
        bench.set(&[
            ("constant_valid", 1),
            ("constant_index", index.into()),
            ("constant_value", value as u64),
            ("constant_exponent", exponent as u64),
        ])?;
        bench.cycle();
    }
    bench.set(&[("constant_valid", 0)])
}

struct SetupChecker<'a> {
    design: RuntimeWidths,
    layout: Layout,
    load: &'a SetupLoad,
    offered: Vec<&'a VolumeSplat>,
    directions: Option<DirectionPorts>,
    culled: [u64; 6],
}

/// Where directions come, each once and at its own time, and how many have come.
struct DirectionPorts {
    valid: Port,
    seen: Port,
    direction: Port,
    widths: Widths,
    came: usize,
}

impl DirectionPorts {
    /// Nothing if the program gives none.
    fn new(simulation: &Simulation, circuit: &Circuit) -> Result<Option<DirectionPorts>> {
        if !circuit.program.directs {
            return Ok(None);
        }
        Ok(Some(DirectionPorts {
            valid: simulation.port("direction_valid")?,
            seen: simulation.port("direction_seen")?,
            direction: simulation.port("direction")?,
            widths: circuit.widths,
            came: 0,
        }))
    }
}

impl Checker for SetupChecker<'_> {
    fn observe(&mut self, circuit: &Simulation, _: u64) -> Option<String> {
        let ports = self
            .directions
            .as_mut()
            .filter(|ports| circuit.is(ports.valid))?;
        let number = ports.came;
        ports.came += 1;
        let Some(splat) = self.offered.get(number) else {
            return Some("a direction too many".to_owned());
        };
        let SetupLoad { view, rules, .. } = self.load;
        let wanted = direction(&ports.widths, view, &splat.centre);
        let wanted = wanted.map(|axis| axis.to_bits() as u32);
        let seen = setup(self.design, view, rules, splat).is_ok();
        let got = circuit.words(ports.direction);
        (got != wanted || circuit.is(ports.seen) != seen)
            .then(|| format!("splat {number}: direction {got:x?}, not {wanted:x?}; seen: {seen}"))
    }

    fn check(&mut self, number: usize, answer: &[Vec<u32>]) -> Option<String> {
        let SetupLoad { view, rules, .. } = self.load;
        let expected = setup(self.design, view, rules, self.offered[number]);
        let place = |cull| Cull::ALL.iter().position(|known| *known == cull);
        if let Err(cull) = &expected {
            self.culled[place(*cull)?] += 1;
        }
        let known = |reason: u32| Cull::ALL.get((reason as usize).wrapping_sub(1)).copied();
        let (reason, got) = (answer[0][0], packet(&answer[2]));
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

//! Look-up tables inside of adders.
//!
//! A CCU2C of an ECP5 is two look-up tables of four inputs with a carry through both. Yosys 0.23 gives each half the
//! two bits that it adds, so that a table stands before it wherever a number is negated, chosen or joined on its way.
//! This does on the netlist what the vendors' tools do: a table moves in where adders alone read it and have inputs
//! left.
//!
//! A half's table says where the carry that comes goes through (p). Where it does not, the half gives the carry that
//! its first two inputs have in the table beside zeros (g; cells_sim.v of Yosys). So a half may be another table as
//! long as p is the same for all inputs, and g wherever p is 0.

use crate::netlist::{Bit, NetlistCell, NetlistModule};
use std::collections::{BTreeMap, BTreeSet, HashMap};

const TABLE: &str = "LUT4";

/// What the pins of an adder's halves end with.
const HALVES: [&str; 2] = ["0", "1"];

/// Inputs of a table.
const PINS: [&str; 4] = ["A", "B", "C", "D"];

/// A table of four inputs: a cell of its own, or half an adder.
#[derive(Clone, Debug, PartialEq)]
struct Table {
    /// The answer to each number that the inputs make, the first input its lowest bit.
    answers: u16,
    pins: [Bit; 4],
}

/// Half an adder: its cell and what its pins end with.
type Half = (String, &'static str);

/// Who reads a net: half an adder, or anything else.
type Readers = HashMap<u64, Vec<Option<Half>>>;

/// Moves tables of a module into adders; gives how many tables there are no more.
pub fn move_in(module: &mut NetlistModule) -> u64 {
    let before = module.cells.len();
    let mut readers = readers(module);
    loop {
        let left = module.cells.len();
        let of_kind = module.cells.iter().filter(|(_, cell)| cell.kind == TABLE);
        let names: Vec<String> = of_kind.map(|(name, _)| name.clone()).collect();
        for name in names {
            take_in(&mut module.cells, &mut readers, &name);
        }
        if module.cells.len() == left {
            return (before - left) as u64;
        }
    }
}

fn readers(module: &NetlistModule) -> Readers {
    let mut readers = Readers::new();
    let mut read = |net, reader| readers.entry(net).or_default().push(reader);
    let ports = module.ports.values().flat_map(|port| &port.bits);
    ports.filter_map(Bit::net).for_each(|net| read(net, None));
    for (name, cell) in &module.cells {
        let halves = HALVES.map(|half| Some((half, Table::of(cell, half)?)));
        let [Some(first), Some(second)] = halves else {
            cell.inputs().for_each(|net| read(net, None));
            continue;
        };
        for (half, table) in [first, second] {
            let reader = (name.clone(), half);
            table.nets().for_each(|net| read(net, Some(reader.clone())));
        }
        cell.net("CIN").into_iter().for_each(|net| read(net, None));
    }
    readers
}

/// Moves one table into all that read it, if every one has room.
fn take_in(
    cells: &mut BTreeMap<String, NetlistCell>,
    readers: &mut Readers,
    name: &str,
) -> Option<()> {
    let table = Table::of(&cells[name], "")?;
    let output = cells[name].net("Z")?;
    let halves: Option<BTreeSet<Half>> = readers.get(&output)?.iter().cloned().collect();
    let mut widened = Vec::new();
    for (cell, half) in halves? {
        let before = Table::of(&cells[&cell], half)?;
        let after = before.with(&table, output)?;
        widened.push(((cell, half), before, after));
    }
    for (half, before, after) in widened {
        let (cell, suffix) = &half;
        let cell = cells.get_mut(cell)?;
        cell.set(&format!("INIT{suffix}"), &format!("{:016b}", after.answers));
        for (pin, bit) in PINS.iter().zip(&after.pins) {
            cell.connect(&format!("{pin}{suffix}"), bit);
        }
        for net in before.nets() {
            let of_net = readers.get_mut(&net)?;
            of_net.retain(|reader| reader.as_ref() != Some(&half));
        }
        for net in after.nets() {
            readers.entry(net).or_default().push(Some(half.clone()));
        }
    }
    for net in table.nets() {
        let of_net = readers.get_mut(&net)?;
        let own = of_net.iter().position(Option::is_none)?;
        of_net.swap_remove(own);
    }
    cells.remove(name);
    Some(())
}

impl Table {
    /// The table of a cell whose pins end so.
    fn of(cell: &NetlistCell, suffix: &str) -> Option<Table> {
        let answers = cell.parameters.get(&format!("INIT{suffix}"))?;
        let pin = |name| cell.pin(&format!("{name}{suffix}")).cloned();
        let [a, b, c, d] = PINS.map(pin);
        Some(Table {
            answers: u16::from_str_radix(answers, 2).ok()?,
            pins: [a?, b?, c?, d?],
        })
    }

    fn nets(&self) -> impl Iterator<Item = u64> + '_ {
        self.pins.iter().filter_map(Bit::net)
    }

    /// The number that its inputs make of these values of nets.
    fn number(&self, value: impl Fn(u64) -> bool) -> usize {
        let bits = self.pins.iter().map(|bit| match bit {
            Bit::Net(net) => value(*net),
            constant => constant.is("1"),
        });
        let bits = bits.enumerate();
        bits.map(|(place, bit)| usize::from(bit) << place).sum()
    }

    fn answer(&self, number: usize) -> bool {
        self.answers >> number & 1 == 1
    }

    /// This half of an adder with the table in it that drives one of its inputs, if it has inputs for that.
    fn with(&self, table: &Table, driven: u64) -> Option<Table> {
        let others = self.nets().filter(|net| *net != driven);
        let inputs: BTreeSet<u64> = others.chain(table.nets()).collect();
        if inputs.len() > PINS.len() {
            return None;
        }
        let inputs = Vec::from_iter(inputs);
        let rows: Vec<(bool, bool)> = (0..1usize << inputs.len())
            .map(|row| {
                let place = |net| inputs.binary_search(&net);
                let given = |net| place(net).is_ok_and(|place| row >> place & 1 == 1);
                let moved = table.answer(table.number(given));
                let number = self.number(|net| if net == driven { moved } else { given(net) });
                (self.answer(number), self.answer(number & 3))
            })
            .collect();
        orders().find_map(|order| half(&inputs, &rows, order))
    }
}

/// Half an adder whose inputs stand in this order, if it can give p and g of every row.
fn half(inputs: &[u64], rows: &[(bool, bool)], order: [usize; 4]) -> Option<Table> {
    let idle: usize = order[inputs.len()..].iter().map(|pin| 1 << pin).sum();
    let number = |row: usize| {
        let bits = (0..inputs.len()).map(|input| (row >> input & 1) << order[input]);
        bits.sum::<usize>() | idle
    };
    let mut answers = [None; 16];
    for (row, (passes, _)) in rows.iter().enumerate() {
        answers[number(row)] = Some(*passes);
    }
    for (row, (passes, carry)) in rows.iter().enumerate() {
        if !passes && answers[number(row) & 3].get_or_insert(*carry) != carry {
            return None;
        }
    }
    let mut pins = PINS.map(|_| Bit::Constant("1".to_owned()));
    for (input, pin) in inputs.iter().zip(order) {
        pins[pin] = Bit::Net(*input);
    }
    let answers = answers.iter().enumerate();
    let answers = answers.map(|(place, answer)| u16::from(*answer == Some(true)) << place);
    Some(Table {
        answers: answers.sum(),
        pins,
    })
}

/// All orders of four pins.
fn orders() -> impl Iterator<Item = [usize; 4]> {
    let all = (0..256).map(|number: usize| [0, 2, 4, 6].map(|shift| number >> shift & 3));
    all.filter(|order| (0..4).all(|pin| order.contains(&pin)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::netlist::Netlist;
    use crate::tools;
    use splatline_sim::scene::synthetic::Random;
    use std::fs;

    fn net(pin: u64) -> Bit {
        Bit::Net(pin)
    }

    /// Whatever table moves into whatever half: where it does, sum and carry are the same for all inputs.
    #[test]
    fn sum_and_carry_stay_the_same() {
        let mut random = Random(1);
        let mut found = 0;
        for _ in 0..20_000 {
            let word = random.next();
            let of = |place: u64| net(word >> (48 + 2 * place) & 3);
            let constant = Bit::Constant((word >> 40 & 1).to_string());
            let adder = Table {
                answers: word as u16,
                pins: [of(0), of(1), constant.clone(), net(9)],
            };
            let table = Table {
                answers: (word >> 16) as u16,
                pins: [of(4), of(5), of(6), constant],
            };
            let Some(merged) = adder.with(&table, 9) else {
                continue;
            };
            found += 1;
            for values in 0..16u64 {
                let given = |net: u64| values >> net & 1 == 1;
                let moved = table.answer(table.number(given));
                let before = adder.number(|net| if net == 9 { moved } else { given(net) });
                let after = merged.number(given);
                assert_eq!(
                    adder.answer(before),
                    merged.answer(after),
                    "{adder:?}, {table:?}: {merged:?}"
                );
                if !adder.answer(before) {
                    assert_eq!(
                        adder.answer(before & 3),
                        merged.answer(after & 3),
                        "{adder:?}, {table:?}: {merged:?}"
                    );
                }
            }
        }
        assert!(found > 5_000, "{found}");
    }

    /// Sums of negated, chosen and joined numbers: what Yosys' solver finds equal, and how many tables are gone.
    #[test]
    #[cfg_attr(not(has_rtl), ignore = "needs Yosys and Icarus Verilog")]
    fn the_circuit_gives_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        fs::write(
            path("subject.sv"),
            "module subject(input logic [7:0] a, b, c, input logic s, t, output logic [7:0] negated, chosen, joined, shared, apart);
              assign negated = a + (b ^ {8{s}}) + {7'd0, s};
              assign chosen = a + (s ? b : c);
              assign joined = (a | b | c & {8{t}}) + {7'd0, s};
              assign {shared, apart} = {a + (b & c), (b & c) - a};
            endmodule",
        )
        .unwrap();
        let synthesis = "synth_ecp5 -abc9 -top subject; write_json";
        tools::yosys(&format!(
            "read_verilog -sv {}; {synthesis} {}",
            path("subject.sv"),
            path("before.json")
        ))
        .unwrap();
        let mut netlist: Netlist = tools::json(&folder.path().join("before.json")).unwrap();
        let module = netlist.modules.get_mut("subject").unwrap();
        let tables = |module: &NetlistModule| {
            let cells = module.cells.values();
            cells.filter(|cell| cell.kind == TABLE).count() as u64
        };
        let before = tables(module);
        let gone = move_in(module);
        // The lowest bit of `joined` would need a fifth input.
        assert_eq!((gone, tables(module)), (before - 1, 1));
        fs::write(path("after.json"), serde_json::to_string(&netlist).unwrap()).unwrap();
        tools::yosys(&format!(
            "read_json {}; read_verilog -overwrite +/ecp5/cells_sim.v; prep -flatten -top subject; \
             rename subject found; read_verilog -sv {}; proc; miter -equiv -flatten subject found both; \
             sat -verify -prove trigger 0 both",
            path("after.json"),
            path("subject.sv")
        ))
        .unwrap();
    }
}

//! Requests to a memory part for the simulators of DRAM: every burst in the order of the cycles in which it was asked
//! for.
//!
//! | format | a line |
//! |---|---|
//! | Ramulator 2, front end `LoadStoreTrace` | `LD 0x1c0` or `ST 0x1c0` |
//! | DRAMsim3, trace CPU | `0x1c0 READ 1234`, the cycle in clocks of the part |
//!
//! The three phases of a picture follow each other. Ramulator's format has no cycles: it is asked as fast as it takes
//! requests.

use crate::machine::memory::Access;
use crate::machine::memory::parts::DramPart;

fn in_order(accesses: &[Access]) -> Vec<Access> {
    let mut sorted = accesses.to_vec();
    sorted.sort_by_key(|access| access.cycle);
    sorted
}

pub fn ramulator2(accesses: &[Access]) -> String {
    let line = |access: Access| {
        let what = if access.write { "ST" } else { "LD" };
        format!("{what} {:#x}\n", access.address)
    };
    in_order(accesses).into_iter().map(line).collect()
}

/// For DRAMsim3; a machine with this clock and part.
pub fn dramsim3(accesses: &[Access], part: &DramPart, clock_mhz: u32) -> String {
    let machine = 1000 * u128::from(clock_mhz.max(1));
    let line = |access: Access| {
        let what = if access.write { "WRITE" } else { "READ" };
        let clock = u128::from(access.cycle) * u128::from(part.khz) / machine;
        format!("{:#x} {what} {clock}\n", access.address)
    };
    in_order(accesses).into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::memory::parts::PARTS;

    #[test]
    fn lines_are_those_of_the_simulators() {
        let access = |cycle, address, write| Access {
            cycle,
            address,
            write,
        };
        let all = [access(7, 0x40, true), access(2, 0x1c0, false)];
        assert_eq!(ramulator2(&all), "LD 0x1c0\nST 0x40\n");
        let part = PARTS
            .iter()
            .find(|part| part.name == "ddr3-1600-x16")
            .unwrap();
        assert_eq!(dramsim3(&all, part, 200), "0x1c0 READ 8\n0x40 WRITE 28\n");
    }
}

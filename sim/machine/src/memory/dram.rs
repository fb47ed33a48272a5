//! One channel of DRAM: banks with an open row each, a data bus with a direction, refresh.
//!
//! Requests are served in the order in which they come, bursts of a request one after the other; rows stay open. A bank
//! is precharged and activated for a later request while earlier ones are on the bus, as the queue of a controller
//! does. Every command is issued in the first clock that all its rules allow:
//!
//! ```text
//! activate  >= request, precharge + rp, any activation + rrd, the fourth activation before + faw
//! command   >= activate + rcd, command before + ccd (same direction),
//!              write data + wtr (read after write), read data + a clock on a bus of both edges (write after read)
//! precharge >= activate + ras, read + rtp, write data + wr
//! ```
//!
//! Left out: conflicts on the command bus, groups of banks, reordering, power-down, reading levels.

use super::parts::DramPart;
#[cfg(test)]
use super::tests::{DramCommand, Issued};

/// What a channel did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct DramCounts {
    /// Bursts read.
    pub reads: u64,
    /// Bursts written.
    pub writes: u64,
    /// Bursts whose row was open.
    pub row_hits: u64,
    /// Bursts whose bank had no row open.
    pub row_misses: u64,
    /// Bursts whose bank had another row open.
    pub row_conflicts: u64,
    /// Refreshes of all banks.
    pub refreshes: u64,
    /// Changes of the bus's direction.
    pub turnarounds: u64,
}

/// A bank, by times of the part's clock.
#[derive(Clone, Copy, Debug, Default)]
struct Bank {
    open: Option<u64>,
    /// First clocks of the next activation, command and precharge.
    activate: u64,
    command: u64,
    precharge: u64,
}

/// Where on the data bus a burst was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transfer {
    /// First clock with data.
    pub start: u64,
    /// One past the last.
    pub end: u64,
}

/// The channel.
#[derive(Clone, Debug)]
pub struct Dram {
    part: &'static DramPart,
    banks: Vec<Bank>,
    /// The last four activations, oldest first, plus one; 0 before there were any.
    activations: [u64; 4],
    /// The last command and its direction.
    last: Option<(u64, bool)>,
    refresh: u64,
    /// What it did so far.
    pub counts: DramCounts,
    /// Its commands, for tests.
    #[cfg(test)]
    pub(super) log: Option<Vec<Issued>>,
}

impl Dram {
    /// A channel with all rows closed.
    pub fn new(part: &'static DramPart) -> Dram {
        Dram {
            part,
            banks: vec![Bank::default(); part.banks as usize],
            activations: [0; 4],
            last: None,
            refresh: part.refi,
            counts: DramCounts::default(),
            #[cfg(test)]
            log: None,
        }
    }

    /// Serves the burst that holds an address, requested in a clock.
    pub fn burst(&mut self, at: u64, address: u64, write: bool) -> Transfer {
        let at = self.refreshed(at);
        // Row, bank, column: a stream walks through all banks, so that the next row opens meanwhile.
        let row_of_all = address / self.part.row_bytes;
        let (row, number) = (row_of_all / self.part.banks, row_of_all % self.part.banks);
        let ready = self.open(at, number as usize, row);
        let command = ready.max(self.bus_free(write));
        let part = self.part;
        let start = command + if write { part.cwl } else { part.cl };
        let end = start + part.burst_clocks();
        let closing = if write {
            end + part.wr
        } else {
            command + part.rtp
        };
        let bank = &mut self.banks[number as usize];
        bank.precharge = bank.precharge.max(closing);
        self.note(command, write);
        #[cfg(test)]
        self.issue(command, DramCommand::moving(write), number, row);
        Transfer { start, end }
    }

    /// The clock after which the channel's bus is free.
    pub fn idle_at(&self) -> u64 {
        let latency = |write| if write { self.part.cwl } else { self.part.cl };
        self.last.map_or(0, |(command, write)| {
            command + latency(write) + self.part.burst_clocks()
        })
    }

    /// Opens a row; gives the first clock of a command to it.
    fn open(&mut self, at: u64, number: usize, row: u64) -> u64 {
        let part = self.part;
        let [oldest, .., newest] = self.activations;
        let bank = &mut self.banks[number];
        if bank.open == Some(row) {
            self.counts.row_hits += 1;
            return at.max(bank.command);
        }
        let mut activate = at.max(bank.activate);
        match bank.open {
            Some(_) => {
                self.counts.row_conflicts += 1;
                activate = activate.max(at.max(bank.precharge) + part.rp);
            }
            None => self.counts.row_misses += 1,
        }
        // Stored plus one, so that 0 is none.
        let after = |stored: u64, wait: u64| if stored == 0 { 0 } else { stored - 1 + wait };
        let activate = activate
            .max(after(newest, part.rrd))
            .max(after(oldest, part.faw));
        self.activations.rotate_left(1);
        self.activations[3] = activate + 1;
        #[cfg(test)]
        let closed = bank.open.map(|before| (at.max(bank.precharge), before));
        bank.open = Some(row);
        bank.command = activate + part.rcd;
        bank.precharge = activate + part.ras;
        let command = bank.command;
        #[cfg(test)]
        {
            if let Some((at, before)) = closed {
                self.issue(at, DramCommand::Precharge, number as u64, before);
            }
            self.issue(activate, DramCommand::Activate, number as u64, row);
        }
        command
    }

    /// The first clock in which the bus takes a command of this direction.
    fn bus_free(&self, write: bool) -> u64 {
        let part = self.part;
        match (self.last, write) {
            (None, _) => 0,
            (Some((command, before)), now) if before == now => command + part.ccd,
            (Some((command, true)), _) => command + part.cwl + part.burst_clocks() + part.wtr,
            (Some((command, _)), _) => {
                let gap = part.rate;
                (command + part.cl + part.burst_clocks() + gap).saturating_sub(part.cwl)
            }
        }
    }

    fn note(&mut self, command: u64, write: bool) {
        self.counts.turnarounds += u64::from(self.last.is_some_and(|(_, before)| before != write));
        self.last = Some((command, write));
        if write {
            self.counts.writes += 1
        } else {
            self.counts.reads += 1
        }
    }

    /// Refreshes that are due before a request is served; gives the first clock in which it can be.
    fn refreshed(&mut self, at: u64) -> u64 {
        let part = self.part;
        let now = at.max(self.last.map_or(0, |(command, _)| command));
        if now < self.refresh {
            return at;
        }
        // Those of a long pause are over but for the last.
        let due = (now - self.refresh) / part.refi;
        let begin = self.refresh + due * part.refi;
        self.counts.refreshes += due + 1;
        self.refresh = begin + part.refi;
        #[cfg(test)]
        for bank in 0..self.banks.len() {
            if let Some(row) = self.banks[bank].open {
                let at = self.banks[bank].precharge.max(begin);
                self.issue(at, DramCommand::Precharge, bank as u64, row);
            }
        }
        let open = self.banks.iter().filter(|bank| bank.open.is_some());
        let closed = open.map(|bank| bank.precharge.max(begin) + part.rp).max();
        let end = closed.unwrap_or(begin).max(begin) + part.rfc;
        #[cfg(test)]
        self.issue(end - part.rfc, DramCommand::Refresh, 0, 0);
        for bank in &mut self.banks {
            bank.open = None;
            bank.activate = bank.activate.max(end);
        }
        at
    }
}

//! Memory parts: organisation and timings of real DRAM, in clocks of the part, with the data sheet that they are from.
//!
//! The figures were entered by hand from the sheets that `source` names; the tests state them once more in nanoseconds, and do not read the sheets.
//! Times that a data sheet gives in nanoseconds are rounded up to whole clocks here, as a controller has to.

/// One memory part on one channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DramPart {
    /// Name in a machine file.
    pub name: &'static str,
    /// What it is, and where its figures stand.
    pub source: &'static str,
    /// Clock, kHz.
    pub khz: u64,
    /// Transfers per clock: 1, or 2 on both edges.
    pub rate: u64,
    /// Bytes of a transfer.
    pub bus_bytes: u64,
    /// Transfers of a burst.
    pub burst: u64,
    /// Banks, a power of two.
    pub banks: u64,
    /// Bytes of a row.
    pub row_bytes: u64,
    /// From a read command to its data.
    pub cl: u64,
    /// From a write command to its data.
    pub cwl: u64,
    /// From an activation to a command.
    pub rcd: u64,
    /// From a precharge to an activation.
    pub rp: u64,
    /// From an activation to a precharge.
    pub ras: u64,
    /// Between activations of two banks.
    pub rrd: u64,
    /// Between an activation and the fourth after it.
    pub faw: u64,
    /// Between two commands of the same direction.
    pub ccd: u64,
    /// From the last data written to a read command.
    pub wtr: u64,
    /// From the last data written to a precharge.
    pub wr: u64,
    /// From a read command to a precharge.
    pub rtp: u64,
    /// Between two refreshes.
    pub refi: u64,
    /// How long a refresh takes.
    pub rfc: u64,
}

/// All parts.
pub const PARTS: [DramPart; 3] = [
    DramPart {
        name: "sdr-166-x16",
        source: "256 Mbit SDRAM, 4 banks x 8192 rows x 512 columns x 16, -6A at 166 MHz: Micron MT48LC16M16A2 data sheet, tables of AC characteristics; \
                 bursts of 8; 8192 refreshes in 64 ms",
        khz: 166_667,
        rate: 1,
        bus_bytes: 2,
        burst: 8,
        banks: 4,
        row_bytes: 1024,
        cl: 3,
        cwl: 0,
        rcd: 3,
        rp: 3,
        ras: 7,
        rrd: 2,
        faw: 0,
        ccd: 8,
        wtr: 0,
        wr: 2,
        rtp: 8,
        refi: 1302,
        rfc: 10,
    },
    DramPart {
        name: "ddr3-1600-x16",
        source: "4 Gbit DDR3-1600K (11-11-11), 8 banks x 32768 rows x 1024 columns x 16: JEDEC JESD79-3F, tables of speed bins and of timing parameters \
                 (2 KB page); Micron MT41K256M16 data sheet",
        khz: 800_000,
        rate: 2,
        bus_bytes: 2,
        burst: 8,
        banks: 8,
        row_bytes: 2048,
        cl: 11,
        cwl: 8,
        rcd: 11,
        rp: 11,
        ras: 28,
        rrd: 6,
        faw: 32,
        ccd: 4,
        wtr: 6,
        wr: 12,
        rtp: 6,
        refi: 6240,
        rfc: 208,
    },
    DramPart {
        name: "lpddr4-3200-x32",
        source: "two channels of 8 Gbit x 16 in lockstep, LPDDR4-3200, 8 banks x 2 KB a channel, bursts of 16, read latency 28 and write latency 14 (set A, no DBI): \
                 JEDEC JESD209-4B, tables of core AC timing and of refresh",
        khz: 1_600_000,
        rate: 2,
        bus_bytes: 4,
        burst: 16,
        banks: 8,
        row_bytes: 4096,
        cl: 28,
        cwl: 14,
        rcd: 29,
        rp: 29,
        ras: 68,
        rrd: 16,
        faw: 64,
        ccd: 8,
        wtr: 16,
        wr: 29,
        rtp: 12,
        refi: 6246,
        rfc: 448,
    },
];

impl DramPart {
    /// The part of that name.
    pub fn named(name: &str) -> Option<&'static DramPart> {
        PARTS.iter().find(|part| part.name == name)
    }

    /// Bytes of a burst.
    pub fn burst_bytes(&self) -> u64 {
        self.bus_bytes * self.burst
    }

    /// Clocks in which a burst is on the bus.
    pub fn burst_clocks(&self) -> u64 {
        self.burst / self.rate
    }

    /// Bytes a second that its bus can move.
    pub fn peak_bytes_per_s(&self) -> u64 {
        self.khz * 1000 * self.rate * self.bus_bytes
    }
}

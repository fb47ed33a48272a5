//! How circuits are verilated, by the build script and while the program runs: what a register holds before reset is drawn by lot.

/// Verilator's options for every circuit.
pub(crate) const OPTIONS: [&str; 6] = [
    "--cc",
    "-O3",
    "--x-assign",
    "unique",
    "--x-initial",
    "unique",
];

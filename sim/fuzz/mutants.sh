#!/bin/sh
# Mutants of the kernel: `sim/fuzz/mutants.sh --help` says how to choose them, mutants/src/main.rs how they are tried.
cd "$(dirname "$0")/mutants" || exit 1
# A target folder of its own, beside that of the mutated copy.
CARGO_TARGET_DIR=../target/tool cargo run --release --quiet --locked -- "$@"

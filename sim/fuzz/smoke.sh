#!/bin/sh
# Runs every fuzz target for a few seconds (first argument, default 5). Memory is limited to 512 MB.
cd "$(dirname "$0")" || exit 1
cargo +nightly --version >/dev/null 2>&1 || { echo "fuzz smoke skipped: no nightly toolchain (rustup toolchain install nightly)"; exit 0; }
cargo +nightly fuzz --version >/dev/null 2>&1 || { echo "fuzz smoke skipped: no cargo-fuzz (cargo install cargo-fuzz)"; exit 0; }
for target in ${FUZZ_TARGETS:-setup packet draw ply splat spz nrrd}; do
    cargo +nightly fuzz run --fuzz-dir . "$target" -- -max_total_time="${1:-5}" -max_len=2048 -rss_limit_mb=512 || exit 1
done

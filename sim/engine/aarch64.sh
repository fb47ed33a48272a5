#!/usr/bin/env bash
# The engine on a processor that is not x86-64: its vectors are arrays there, and setup, pixels and surfaces must still
# be the kernel's bit for bit. A short set of the tests, of arbitrary words among them, built for aarch64 (without a C
# compiler or system libraries: musl) and run under QEMU.
set -euo pipefail
cd "$(dirname "$0")/../.."
command -v qemu-aarch64 >/dev/null || { echo "qemu-aarch64 is missing (package qemu-user)" >&2; exit 1; }
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_LINKER=rust-lld
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_RUNNER=qemu-aarch64
export PROPTEST_CASES=${PROPTEST_CASES:-8}
# Left out: captured and deep scenes, and a tile filled by 12,000 surfaces, which take minutes under emulation.
cargo test --locked --target aarch64-unknown-linux-musl -p splatline-engine --lib -- fast:: --skip captured --skip a_full_pixel --skip what_is_left_out

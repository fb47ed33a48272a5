#!/usr/bin/env bash
# The wheels for Linux on x86-64 and aarch64, for every glibc from 2.17 on: sim/python/wheels.sh [FOLDER]
#
# Needs `pip install maturin ziglang` and `rustup target add aarch64-unknown-linux-gnu`. Zig links against an old glibc;
# a library that asks for more than manylinux2014 allows is an error.
set -euo pipefail
cd "$(dirname "$0")/../.."
for machine in x86_64 aarch64; do
    maturin build --locked --release --zig --compatibility manylinux2014 --target "$machine-unknown-linux-gnu" -m sim/python/Cargo.toml \
        -o "${1:-target/wheels}"
done

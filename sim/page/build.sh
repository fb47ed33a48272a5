#!/usr/bin/env bash
# Builds the live page's wasm. Without an argument it becomes sim/page/page.wasm; with `--check` it is compared with that file.
#
# The bytes depend on the sources and the compiler's version, and not on where either lies: paths are mapped to fixed names. With
# another compiler than the one that page.wasm names in page.wasm.rustc, --check says so and builds only: the browser's tests then show
# whether the module that is in the tree draws the host's bits.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
target=wasm32-unknown-unknown
out=${CARGO_TARGET_DIR:-$root/target}
cargo_home=${CARGO_HOME:-$HOME/.cargo}
sysroot=$(rustc --print sysroot)
export RUSTFLAGS="--remap-path-prefix=$root=/splatline --remap-path-prefix=$cargo_home=/cargo --remap-path-prefix=$sysroot=/rust"
cargo build --locked -p splatline-page --profile page --target $target
built=$out/$target/page/splatline_page.wasm
compiler=$(rustc --version)
if [ "${1:-}" != --check ]; then
    cp "$built" page.wasm
    echo "$compiler" > page.wasm.rustc
    echo "page.wasm: $(wc -c < page.wasm) bytes by $compiler"
elif [ "$compiler" != "$(cat page.wasm.rustc)" ]; then
    echo "page.wasm was built by $(cat page.wasm.rustc), this is $compiler: bytes are not compared, the browser's tests compare the pictures"
elif cmp -s "$built" page.wasm; then
    echo "page.wasm is what the sources give: $(wc -c < page.wasm) bytes"
else
    echo "build.sh: page.wasm is not what the sources give; run sim/page/build.sh and commit its result" >&2
    exit 1
fi

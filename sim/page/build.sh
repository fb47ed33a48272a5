#!/usr/bin/env bash
# Builds the live page's wasm. Without an argument it becomes sim/src/page/page.wasm; with `--check` it is compared with
# that file.
#
# The bytes depend on the sources and the compiler's version, and not on where either lies: paths are mapped to fixed
# names. With another compiler than the one that page.wasm.rustc beside it names, --check says so and builds only: the
# browser's tests then show whether the module that is in the tree draws the host's bits.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
kept=$root/sim/src/page/page.wasm
target=wasm32-unknown-unknown
out=${CARGO_TARGET_DIR:-$root/target}
cargo_home=${CARGO_HOME:-$HOME/.cargo}
sysroot=$(rustc --print sysroot)
export RUSTFLAGS="--remap-path-prefix=$root=/splatline --remap-path-prefix=$cargo_home=/cargo --remap-path-prefix=$sysroot=/rust"
cargo build --locked -p splatline-page --profile page --target $target
built=$out/$target/page/splatline_page.wasm
compiler=$(rustc --version)
if [ "${1:-}" != --check ]; then
    cp "$built" "$kept"
    echo "$compiler" > "$kept.rustc"
    echo "page.wasm: $(wc -c < "$kept") bytes by $compiler"
elif [ "$compiler" != "$(cat "$kept.rustc")" ]; then
    echo "page.wasm was built by $(cat "$kept.rustc"), this is $compiler: bytes are not compared, the browser's tests compare the pictures"
elif cmp -s "$built" "$kept"; then
    echo "page.wasm is what the sources give: $(wc -c < "$kept") bytes"
else
    echo "build.sh: page.wasm is not what the sources give; run sim/page/build.sh and commit its result" >&2
    exit 1
fi

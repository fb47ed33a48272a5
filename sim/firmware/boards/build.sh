#!/bin/sh
# Builds the images of real boards and fails where one takes more flash or RAM than its budget (scenes included). Nothing is run: the emulated image of
# sim/firmware/frame draws the same bits, and frames a second follow from its counted instructions, at the clock and the cycles an instruction below.
#
#   sim/firmware/boards/build.sh
set -eu
cd "$(dirname "$0")"
fail() { echo "boards/build.sh: $1" >&2; exit 1; }
tools=$(ls -d "$(rustc --print sysroot)"/lib/rustlib/*/bin/llvm-size 2>/dev/null | head -1)
[ -n "$tools" ] || fail "llvm-size is missing: rustup component add llvm-tools"
# The images link by cortex-m-rt's script, not by the emulated ones' beside this folder.
export RUSTFLAGS="-Clink-arg=--nmagic -Clink-arg=-Tlink.x"
echo "| board | flash, bytes | budget | RAM, bytes | budget |"
echo "|---|--:|--:|--:|--:|"
failed=0
# board NAME TARGET FLASH RAM
board() {
    (cd "$1" && cargo build --quiet --locked --release --target "$2") || fail "$1 does not build"
    elf=${CARGO_TARGET_DIR:-$1/target}/$2/release/splatline-$1
    set -- "$1" "$3" "$4" $("$tools" -A "$elf" | awk '
        /^\.(boot2|vector_table|text|rodata|data) / { flash += $2 }
        /^\.(data|bss|uninit) / { ram += $2 }
        END { print flash, ram }')
    echo "| $1 | $4 | $2 | $5 | $3 |"
    [ "$4" -le "$2" ] && [ "$5" -le "$3" ] || { echo "boards/build.sh: $1 exceeds its budget" >&2; failed=1; }
}
board rp2040 thumbv6m-none-eabi 160000 220000
exit $failed

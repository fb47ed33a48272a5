#!/bin/sh
# Builds the images of real boards, fails where one takes more flash or RAM than its budget (scenes included), and
# estimates frames a second. Nothing is run: the emulated image of sim/firmware/frame draws the same bits. To measure a
# board, let a free pin change its level at every first strip (`send` of `splatline_frame::show` gets its row) and look
# at its frequency: a period is two frames, with what it takes to send them.
#
#   sim/firmware/boards/build.sh
set -eu
cd "$(dirname "$0")"
fail() { echo "boards/build.sh: $1" >&2; exit 1; }
tools=$(ls -d "$(rustc --print sysroot)"/lib/rustlib/*/bin/llvm-size 2>/dev/null | head -1)
[ -n "$tools" ] || fail "llvm-size is missing: rustup component add llvm-tools"
# What sim/firmware/frame/run.sh counts, for 200 and 1000 splats.
costs() { sed -n "s/^ *$1.*) echo \"\([0-9.]*\):[^ ]* \([0-9.]*\):.*/\1 \2/p" ../frame/run.sh; }
echo "| board | flash, bytes | budget | RAM, bytes | budget | MHz | cycles an instruction, assumed | frames a second by one core, estimated: 200; 1000 splats |"
echo "|---|--:|--:|--:|--:|--:|--:|--:|"
failed=0
# board NAME TARGET SCRIPT FLASH RAM MHZ CYCLES COUNTED
board() {
    # The images link by their HAL's script, not by the emulated ones' beside this folder.
    (cd "$1" && RUSTFLAGS="-Clink-arg=-T$3" cargo build --quiet --locked --release --target "$2") || fail "$1 does not build"
    elf=${CARGO_TARGET_DIR:-$1/target}/$2/release/splatline-$1
    # Of an ESP32, .trap and .rwtext are run from RAM.
    taken=$("$tools" -A "$elf" | awk '
        /^\.(boot2|vector_table|start_block|flash\.appdesc|trap|rwtext|text|rodata|data) / { flash += $2 }
        /^\.(trap|rwtext|data|bss|uninit) / { ram += $2 }
        END { print flash, ram }')
    frames=$(costs "$8" | awk -v mhz="$6" -v cycles="$7" '{ printf "%.1f; %.1f", mhz / cycles / $1, mhz / cycles / $2 }')
    echo "| $1 | ${taken% *} | $4 | ${taken#* } | $5 | $6 | $7 | $frames |"
    [ "${taken% *}" -le "$4" ] && [ "${taken#* }" -le "$5" ] || { echo "boards/build.sh: $1 exceeds its budget" >&2; failed=1; }
}
board rp2040 thumbv6m-none-eabi link.x 160000 220000 125 1.5 thumbv6m
board rp2350 thumbv8m.main-none-eabihf link.x 160000 220000 150 1.3 thumbv7em
board stm32f429 thumbv7em-none-eabi link.x 160000 190000 168 1.4 thumbv7em
board esp32c3 riscv32imc-unknown-none-elf linkall.x 180000 250000 160 1.3 riscv32
exit $failed

#!/bin/sh
# Builds the display example for a Cortex-M0, a Cortex-M4 and an RV32, runs it under QEMU, compares what the display was
# sent with the host's and prints what it costs: instructions, code, tables, RAM and stack. Writes the picture on the
# host.
#
#   sim/firmware/display/run.sh [picture.png]        default: target/measured/display.png
#
# Where a tool is missing it says so and fails.
set -eu
cd "$(dirname "$0")"
targets="thumbv6m-none-eabi thumbv7em-none-eabi riscv32imac-unknown-none-elf"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
fail() { echo "display/run.sh: $1" >&2; exit 1; }
command -v qemu-system-arm >/dev/null || fail "qemu-system-arm is missing: apt-get install --no-install-recommends qemu-system-arm"
command -v qemu-system-riscv32 >/dev/null || fail "qemu-system-riscv32 is missing: apt-get install --no-install-recommends qemu-system-misc"
tools=$(ls -d "$(rustc --print sysroot)"/lib/rustlib/*/bin/llvm-nm 2>/dev/null | head -1)
[ -n "$tools" ] || fail "llvm-nm is missing: rustup component add llvm-tools"
tools=$(dirname "$tools")
work=$CARGO_TARGET_DIR/measured
mkdir -p "$work"
(cd ../counter && cargo build --quiet --locked --release)
counter=$CARGO_TARGET_DIR/release/libsplatline_counter.so
host=$(cargo run --quiet --locked --release -- "${1:-$work/display.png}") || fail "the host's own picture failed"
echo "host:" $host
value() { sed -n "s/^$2=//p" "$1"; }
covered=$(echo "$host" | sed -n 's/^covered=//p')

emulator() {
    case $1 in
    thumbv6m-*) echo "qemu-system-arm -M microbit" ;;
    thumbv7em-*) echo "qemu-system-arm -M mps2-an386" ;;
    riscv32*) echo "qemu-system-riscv32 -M virt -bios none" ;;
    esac
}
phase() { awk -v p="$2" '$1 == "phase" && $2 == p { print $6 }' "$1"; }
section() { "$tools/llvm-size" -A "$1" | awk -v s="$2" '$1 == s { print $2 }'; }

echo
echo "| target | setup per splat | draw per covered pixel | picture | code | tables and constants | RAM | stack |"
echo "|---|---|---|---|---|---|---|---|"
failed=0
for target in $targets; do
    cargo build --quiet --locked --release --target "$target"
    elf=$CARGO_TARGET_DIR/$target/release/splatline-display
    base=$work/$target.display
    "$tools/llvm-nm" -S "$elf" >"$base.symbols"
    timeout 900 $(emulator "$target") -nographic -semihosting-config enable=on,target=native -kernel "$elf" \
        -plugin "$counter,symbols=$base.symbols,addresses=$base.addresses" -d plugin -D "$base.count" \
        2>"$base.out" </dev/null || { cat "$base.out" >&2; fail "$target did not run"; }
    got=$(grep -E '^(checksum|pixels|visible)=' "$base.out" || true)
    [ "$(echo $got)" = "$(echo $host | cut -d ' ' -f 1-3)" ] || { echo "display/run.sh: $target differs from the host:" $got >&2; failed=1; }
    # The image links only without a panic path (board.rs); a formatter would come with one.
    if grep -E 'panicking' "$base.symbols" >&2; then
        echo "display/run.sh: $target: a panic path is linked (above)" >&2; failed=1
    fi
    awk -v t="$target" -v setup="$(phase "$base.count" phase_setup)" -v draw="$(phase "$base.count" phase_draw)" -v n="$covered" -v splats="$(value "$base.out" splats)" \
        -v code="$(section "$elf" .text)" -v constants="$(section "$elf" .rodata)" -v ram="$(section "$elf" .bss)" -v stack="$(value "$base.out" stack)" \
        'BEGIN { printf "| %s | %.0f | %.1f | %.1f million | %d | %d | %d | %d |\n", t, setup / splats, draw / n, (setup + draw) / 1e6, code, constants, ram, stack }'
done
[ $failed = 0 ] && echo "the display is sent the same on every target; no panic path in any image"
exit $failed

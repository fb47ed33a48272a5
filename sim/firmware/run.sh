#!/bin/sh
# Builds the example images for every target, runs them under QEMU, compares checksums with the host and prints a table
# of executed instructions, code, tables, RAM and stack. Counts are exact and repeatable (QEMU plugin in counter/).
#
#   sim/firmware/run.sh             the images built for speed (profile release, opt-level 2)
#   sim/firmware/run.sh small       built for size (opt-level s)
#   sim/firmware/run.sh plain       a footprint table without interpolation
#   sim/firmware/run.sh lossless    centres as mantissas and exponents instead of fixed point
#   sim/firmware/run.sh two-part    the same with a difference to the eye of 48 bits instead of 30
#   sim/firmware/run.sh profile     also the ten costliest functions of each phase
#
# Words may be combined. Where a tool is missing it says so and fails; with SKIP_IF_MISSING=1 it says so and passes.
set -eu
cd "$(dirname "$0")"
profile=release; features=; functions=
for word in "$@"; do
    case $word in
    small) profile=small ;;
    plain | lossless | two-part) features="--features $word" ;;
    profile) functions=10 ;;
    *) echo "run.sh: unknown word '$word': expected small, plain, lossless, two-part or profile" >&2; exit 2 ;;
    esac
done
targets="thumbv6m-none-eabi thumbv7m-none-eabi thumbv7em-none-eabi riscv32im-unknown-none-elf riscv32imac-unknown-none-elf"
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
missing() {
    echo "run.sh: $1" >&2
    [ -n "${SKIP_IF_MISSING:-}" ] && { echo "run.sh: left out" >&2; exit 0; }
    exit 1
}
fail() { echo "run.sh: $1" >&2; exit 1; }

command -v qemu-system-arm >/dev/null || missing "qemu-system-arm is missing: apt-get install --no-install-recommends qemu-system-arm"
command -v qemu-system-riscv32 >/dev/null || missing "qemu-system-riscv32 is missing: apt-get install --no-install-recommends qemu-system-misc"
tools=$(ls -d "$(rustc --print sysroot)"/lib/rustlib/*/bin/llvm-nm 2>/dev/null | head -1)
[ -n "$tools" ] || missing "llvm-nm is missing: rustup component add llvm-tools"
tools=$(dirname "$tools")
for target in $targets; do
    [ -d "$(rustc --print target-libdir --target "$target")" ] || missing "target is missing: rustup target add $target"
done

work=$CARGO_TARGET_DIR/measured
mkdir -p "$work"
(cd counter && cargo build --quiet --release)
cargo test --quiet --lib >/dev/null || fail "the depth order's own tests failed: cargo test --lib"
counter=$CARGO_TARGET_DIR/release/libsplatline_counter.so
host=$(cargo run --quiet --release $features --bin fixed -- "$work/picture.ppm") || fail "the host's own check failed"
echo "host:" $host
covered=$(echo "$host" | sed -n 's/^covered=//p')

emulator() {
    case $1 in
    thumbv6m-*) echo "qemu-system-arm -M microbit" ;;
    thumbv7m-*) echo "qemu-system-arm -M lm3s6965evb" ;;
    thumbv7em-*) echo "qemu-system-arm -M mps2-an386" ;;
    riscv32*) echo "qemu-system-riscv32 -M virt -bios none" ;;
    esac
}

# run TARGET IMAGE: output (QEMU sends it to stderr) in $work/TARGET.IMAGE.out, counts in .count, addresses in
# .addresses
run() {
    elf=$CARGO_TARGET_DIR/$1/$profile/$2
    base=$work/$1.$2
    "$tools/llvm-nm" -S "$elf" >"$base.symbols"
    timeout 900 $(emulator "$1") -nographic -semihosting-config enable=on,target=native -kernel "$elf" \
        -plugin "$counter,symbols=$base.symbols,addresses=$base.addresses" -d plugin -D "$base.count" \
        2>"$base.out" </dev/null || { cat "$base.out" >&2; fail "$1 $2 did not run"; }
}

value() { sed -n "s/^$2=//p" "$1"; }
phase() { awk -v p="$2" '$1 == "phase" && $2 == p { print $6 }' "$1"; }
section() { "$tools/llvm-size" -A "$1" | awk -v s="$2" '$1 == s { print $2 }'; }
symbols() { awk -v p="$2" '$4 ~ p { print $2 }' "$1" | while read -r size; do echo $((0x$size)); done | awk '{ s += $1 } END { print s + 0 }'; }

# Instructions of the functions with the pixel loop that are executed for most covered pixels, or, where the loop draws
# two in turn, for most pairs; what runs once per row is executed for an eighth.
pixel_loop() {
    awk '$4 ~ /Painter32.*paint|pixel_loop.*paint/ { print $1, $2 }' "$1.symbols" | while read -r first size; do
        first=$((0x$first & ~1)); last=$((first + 0x$size))
        awk -v a="$(printf %08x $first)" -v b="$(printf %08x $last)" -v n="$2" \
            '"x" $1 >= "x" a && "x" $1 < "x" b && $2 >= n / 4 { s += $2 } END { print s / n }' "$1.addresses"
    done | awk '{ s += $1 } END { printf "%.1f", s }'
}

echo
echo "| target | setup per splat | float | draw per covered pixel | of which pixel loop | float box | ratio | float spans | ratio | code | tables | scene | RAM | stack |"
echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
failed=0
for target in $targets; do
    cargo build --quiet --profile "$profile" $features --target "$target"
    run "$target" fixed
    run "$target" float
    if [ "$target" != thumbv7m-none-eabi ]; then
        run "$target" loops
        [ "$(value "$work/$target.loops.out" differing),$(value "$work/$target.loops.out" registers_lost)" = 0,0 ] || { echo "run.sh: $target: the loop in assembly differs from its definition" >&2; failed=1; }
    fi
    fixed=$work/$target.fixed; float=$work/$target.float; elf=$CARGO_TARGET_DIR/$target/$profile/fixed
    loop=$(pixel_loop "$fixed" "$covered")
    [ "$loop" != 0.0 ] || { echo "run.sh: $target: no function of the image is known as the pixel loop" >&2; failed=1; }
    got=$(grep -E '^(checksum|visible)=' "$fixed.out")
    [ "$(echo $got)" = "$(echo $host | cut -d ' ' -f 1-2)" ] || { echo "run.sh: $target differs from the host:" $got >&2; failed=1; }
    # The image links only without panic paths (board.rs); divisions of 64 bits and float would show as library
    # functions.
    if grep -E 'panicking|__(aeabi_u?ldivmod|u?divdi3|u?moddi3|aeabi_[fd]|addsf3|mulsf3)' "$fixed.symbols" >&2; then
        echo "run.sh: $target: unwanted functions are linked (above)" >&2; failed=1
    fi
    scene=$(symbols "$fixed.symbols" 'scene.*SCENE')
    # Reset, output, checksum and the division that prints decimals are not the drawing.
    around=$(symbols "$fixed.symbols" 'image_main|board.*print|^reset$|^start$|phase_|u32_div_rem|udivmod|uidiv')
    text=$(section "$elf" .text); constants=$(section "$elf" .rodata); ram=$(section "$elf" .bss)
    awk -v t="$target" -v setup="$(phase "$fixed.count" phase_setup)" -v fsetup="$(phase "$float.count" phase_setup)" \
        -v draw="$(phase "$fixed.count" phase_draw)" -v box="$(phase "$float.count" phase_draw)" -v spans="$(phase "$float.count" phase_draw_again)" \
        -v n="$covered" -v fn="$(value "$float.out" covered_box)" -v fns="$(value "$float.out" covered_spans)" -v loop="$loop" \
        -v code=$((text - around)) -v tables=$((constants - scene)) -v scene="$scene" -v ram="$ram" -v stack="$(value "$fixed.out" stack)" \
        'BEGIN { printf "| %s | %.0f | %.0f | %.1f | %s | %.0f | %.1f | %.0f | %.1f | %d | %d | %d | %d | %d |\n", t, setup / 40, fsetup / 40, draw / n, loop,
            box / fn, (box / fn) / (draw / n), spans / fns, (spans / fns) / (draw / n), code, tables, scene, ram, stack }'
    if [ -n "$functions" ]; then
        awk -v most="$functions" '/^phase/ { n = 0 } n++ <= most { print }' "$fixed.count" | sed 's/^/    /'
    fi
done
[ $failed = 0 ] && echo "assembly equals its definition:" $(cat "$work/thumbv6m-none-eabi.loops.out")
[ $failed = 0 ] && echo "all checksums equal the host's; no panic path, 64-bit division or float in any fixed image"
exit $failed

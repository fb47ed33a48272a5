#!/bin/sh
# Builds the frame for a Cortex-M0+, a Cortex-M4 and an RV32, runs it under QEMU, compares what the display is sent with
# the host's and prints what it costs: instructions for 200, 1000 and 3000 splats, code, tables, RAM and stack. Fails
# where a frame costs 3 % more than it did; says which bars it misses.
#
#   sim/firmware/frame/run.sh [lean18] [small] [profile]
#     lean18: by that design and the kernel's own pixel loop; small: built for size; profile: also the ten costliest
#     functions of each phase
#
# The M0+ image runs on a board with an M3, which executes the same instructions, because the M0 that QEMU has is one
# with 16 KiB of RAM.
set -eu
cd "$(dirname "$0")"
profile=release; functions=; design=micro16; features=
for word in "$@"; do
    case $word in
    lean18) design=lean18; features="--features lean18" ;;
    small) profile=small ;;
    profile) functions=10 ;;
    *) echo "frame/run.sh: unknown word '$word': expected lean18, small or profile" >&2; exit 2 ;;
    esac
done
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
fail() { echo "frame/run.sh: $1" >&2; exit 1; }
command -v qemu-system-arm >/dev/null || fail "qemu-system-arm is missing: apt-get install --no-install-recommends qemu-system-arm"
command -v qemu-system-riscv32 >/dev/null || fail "qemu-system-riscv32 is missing: apt-get install --no-install-recommends qemu-system-misc"
tools=$(ls -d "$(rustc --print sysroot)"/lib/rustlib/*/bin/llvm-nm 2>/dev/null | head -1)
[ -n "$tools" ] || fail "llvm-nm is missing: rustup component add llvm-tools"
tools=$(dirname "$tools")
work=$CARGO_TARGET_DIR/measured
mkdir -p "$work"
(cd ../counter && cargo build --quiet --locked --release)
counter=$CARGO_TARGET_DIR/release/libsplatline_counter.so
cargo run --quiet --locked --release $features -- "$work/frames.ppm" >"$work/host" || fail "the host's own frame failed"
echo "host:" $(cat "$work/host")
grep -E '^(checksum|visible)=' "$work/host" >"$work/host.lines"
covered=$(sed -n 's/^covered=//p' "$work/host" | head -1)

emulator() {
    case $1 in
    thumbv6m-*) echo "qemu-system-arm -M mps2-an385" ;;
    thumbv7em-*) echo "qemu-system-arm -M mps2-an386" ;;
    riscv32*) echo "qemu-system-riscv32 -M virt -bios none" ;;
    esac
}
# What a frame cost when this was written and what it is to cost, in millions of instructions, for 200, 1000 and 3000
# splats; - without a bar.
costs() {
    case $design.$1 in
    lean18.thumbv6m-*) echo "26.6:- 42.4:- 77.3:-" ;;
    lean18.thumbv7em-*) echo "18.2:- 27.1:- 46.6:-" ;;
    lean18.riscv32*) echo "19.3:- 30.0:- 53.2:-" ;;
    *.thumbv6m-*) echo "15.4:18 29.6:35 59.6:-" ;;
    *.thumbv7em-*) echo "10.1:11 18.8:20 37.2:-" ;;
    *.riscv32*) echo "12.7:13 23.1:25 45.2:-" ;;
    esac
}
phase() { awk -v p="phase_$2" '$1 == "phase" && $2 == p { print $6 }' "$1"; }
# Instructions of the pixel loop while 200 splats are drawn.
pixel_loop() { awk '$1 == "phase" { on = $2 == "phase_draw_200" } on && $2 ~ /paint_as|pixel_loop.*paint/ { s += $4 } END { print s + 0 }' "$1"; }
section() { "$tools/llvm-size" -A "$1" | awk -v s="$2" '$1 == s { print $2 }'; }
symbols() { awk -v p="$2" '$4 ~ p { print $2 }' "$1" | while read -r size; do echo $((0x$size)); done | awk '{ s += $1 } END { print s + 0 }'; }

echo
echo "| target | 200 splats: set up, draw, frame | 1000 | 3000 | code | tables | RAM | stack | 200 splats, a covered pixel: draw; pixel loop |"
echo "|---|---|---|---|---|---|---|---|---|"
failed=0 missed=
for target in thumbv6m-none-eabi thumbv7em-none-eabi riscv32imac-unknown-none-elf; do
    cargo build --quiet --locked --profile "$profile" $features --target "$target"
    elf=$CARGO_TARGET_DIR/$target/$profile/splatline-frame
    base=$work/$target.frame
    "$tools/llvm-nm" -S "$elf" >"$base.symbols"
    timeout 900 $(emulator "$target") -nographic -semihosting-config enable=on,target=native -kernel "$elf" \
        -plugin "$counter,symbols=$base.symbols,addresses=$base.addresses" -d plugin -D "$base.count" \
        2>"$base.out" </dev/null || { cat "$base.out" >&2; fail "$target did not run"; }
    grep -E '^(checksum|visible)=' "$base.out" | tr -d '\r' >"$base.lines" || true
    cmp -s "$base.lines" "$work/host.lines" || { echo "frame/run.sh: $target differs from the host:" $(cat "$base.lines") >&2; failed=1; }
    if grep -E 'panicking|__(aeabi_u?ldivmod|u?divdi3|u?moddi3|aeabi_[fd]|addsf3|mulsf3)' "$base.symbols" >&2; then
        echo "frame/run.sh: $target: unwanted functions are linked (above)" >&2; failed=1
    fi
    scene=$(symbols "$base.symbols" 'scene.*(FEW|MANY|ALL)')
    around=$(symbols "$base.symbols" 'image_main|board.*print|^reset$|^start$|phase_|u32_div_rem|udivmod|uidiv')
    row="| $target |"
    set -- $(costs "$target")
    for splats in 200 1000 3000; do
        row="$row $(awk -v a="$(phase "$base.count" setup_$splats)" -v b="$(phase "$base.count" draw_$splats)" \
            'BEGIN { printf "%.1f + %.1f = %.1f", a / 1e6, b / 1e6, (a + b) / 1e6 }') |"
        frame=$(awk -v a="$(phase "$base.count" setup_$splats)" -v b="$(phase "$base.count" draw_$splats)" 'BEGIN { printf "%.1f", (a + b) / 1e6 }')
        above() { awk -v frame="$frame" -v most="$1" 'BEGIN { exit !(frame > most) }'; }
        if [ "$profile" != small ]; then
            ! above "$(awk -v cost="${1%:*}" 'BEGIN { print 1.03 * cost }')" ||
                { echo "frame/run.sh: $target, $splats splats: $frame million instructions, were ${1%:*}" >&2; failed=1; }
            [ "${1#*:}" = - ] || ! above "${1#*:}" || missed="$missed$target, $splats splats: $frame, bar ${1#*:} million instructions
"
        fi
        shift
    done
    covering=$(awk -v draw="$(phase "$base.count" draw_200)" -v loop="$(pixel_loop "$base.count")" -v n="$covered" \
        'BEGIN { printf "%.1f; %.1f", draw / n, loop / n }')
    echo "$row $(($(section "$elf" .text) - around)) | $(($(section "$elf" .rodata) - scene)) | $(section "$elf" .bss) | $(sed -n 's/^stack=//p' "$base.out" | tr -d '\r') | $covering |"
    if [ -n "$functions" ]; then
        awk -v most="$functions" '/^phase/ { n = 0 } n++ <= most { print }' "$base.count" | sed 's/^/    /'
    fi
done
[ -z "$missed" ] || printf '\nbars missed:\n%s\n' "$missed"
[ $failed = 0 ] && echo "the display is sent the same on every target; no panic path, 64-bit division or float in any image"
exit $failed

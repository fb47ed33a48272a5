#!/usr/bin/env bash
# Links every feature set alone for a Cortex-M0+ and prints what it costs: a Markdown table of code, constant tables,
# bytes of state per pixel, and which units' symbols the image holds. Fails if the volume image holds a symbol of a unit
# that it does not use.
#
#   sim/units/sizes.sh > docs/results/sizes.md
set -euo pipefail
cd "$(dirname "$0")"
target=thumbv6m-none-eabi
out=${CARGO_TARGET_DIR:-$PWD/target}/units
tools=$(dirname "$(find "$(rustc --print sysroot)/lib/rustlib" -name rust-lld | head -n 1)")
command -v llvm-size >/dev/null || PATH=$tools:$PATH
others='surface|layers|shading|edge|resolve|points|slabs|stamp|sphere|perspective|sheets|deep|distance'

# Sum of the sizes of an image's sections whose names begin with $2, decimal.
section() { llvm-size -A "$1" | awk -v name="$2" '$1 ~ "^\\"name { sum += $2 } END { print sum + 0 }'; }

echo "# What each set of systems costs"
echo
echo "Printed by \`sim/units/sizes.sh\`: one entry point per row, linked alone for \`$target\` (opt-level s, LTO), in \`standard24\`. Code and tables are the"
echo "bytes of the linked image, state is what one pixel keeps. The footprint table is 16,388 bytes of every row's tables."
echo "The last column names the units of the kernel that left symbols; inlined code shows in the size alone."
echo
echo "| set | systems | code | tables | state per pixel | symbols of other units than volume splats |"
echo "|---|---|---|---|---|---|"
row() {
    CARGO_TARGET_DIR=$out cargo build --quiet --release --target $target --features "$1"
    "$tools/rust-lld" -flavor gnu --gc-sections --entry entry -u STATE \
        "$out/$target/release/libsplatline_units.a" -o "$out/$1.elf"
    found=$(llvm-nm --demangle "$out/$1.elf" | grep -oE "splatline::[a-z_:]*($others)" | grep -oE "($others)\$" | sort -u | paste -sd, - | sed 's/,/, /g' || true)
    if [ "$1" = volume ] && [ -n "$found" ]; then
        echo "sizes.sh: the volume image holds symbols of: $found" >&2
        exit 1
    fi
    if [ "$(section "$out/$1.elf" .rodata)" -lt 16388 ]; then
        echo "sizes.sh: the image of $1 holds no footprint table: its entry point does not draw" >&2
        exit 1
    fi
    echo "| $1 | $2 | $(section "$out/$1.elf" .text) | $(section "$out/$1.elf" .rodata) | $(section "$out/$1.elf" .bss) | ${found:-none} |"
}
row volume "1, 4, 5"
row surface "2, 4, 9"
row layers "2, 4, 10, 11, 12 (4 layers)"
row hybrid "1, 4, 5, 6, 14"
row stamp "1, 4, 5, 6, 7, 14"
row sphere "4, 5, 15, 16"
row sheets "1, 4, 5 with sheet buffers"
row deep "1, 4, 8"

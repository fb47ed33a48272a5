#!/bin/sh
# Worst-case stack from frame sizes and call graph: no measurement, every path counts. Prints the deepest chain of calls
# below the function named (default: the whole image) with each frame's bytes.
#
#   sim/firmware/stack.sh [TARGET [FUNCTION]]        e.g. thumbv6m-none-eabi set_up
#
# Frame sizes are an unstable compiler flag, hence RUSTC_BOOTSTRAP. Functions without a recorded frame (assembly,
# integer helpers, memcpy) count what they push, and 24 bytes at least. Indirect calls and recursion are errors; the
# images have neither.
set -eu
cd "$(dirname "$0")"
target=${1:-thumbv6m-none-eabi}
from=${2:-image_main}
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}/stack"
tools=$(ls -d "$(rustc --print sysroot)"/lib/rustlib/*/bin/llvm-readobj 2>/dev/null | head -1)
[ -n "$tools" ] || { echo "stack.sh: llvm-readobj is missing: rustup component add llvm-tools" >&2; exit 1; }
tools=$(dirname "$tools")
RUSTC_BOOTSTRAP=1 cargo build --quiet --release --target "$target" --bin fixed \
    --config "target.$target.rustflags=[\"-Zemit-stack-sizes\"]"
elf=$CARGO_TARGET_DIR/$target/release/fixed
{
    "$tools/llvm-readobj" --stack-sizes "$elf" |
        awk '/Functions:/ { gsub(/[][,]/, ""); name = $2 } /Size: 0x/ { print "frame", name, substr($2, 3) }' |
        while read -r kind name size; do echo "$kind $name $((0x$size))"; done
    "$tools/llvm-objdump" -d --no-show-raw-insn "$elf" | awk '
        $2 == "push" { print "pushed", name, 4 * split($0, registers, ",") }
        /^[0-9a-f]+ <.*>:$/ { name = substr($2, 2, length($2) - 3) }
        $2 ~ /^(bl|jal|jalr|call|tail|b|b\.w|j)$/ && match($0, /<[^>+]*>/) { print "call", name, substr($0, RSTART + 1, RLENGTH - 2) }
        $2 ~ /^(blx)$/ { print "indirect", name, $3 }' | sort -u
} | awk -v from="$from" '
    $1 == "frame" { frame[$2] = $3 }
    $1 == "pushed" { pushed[$2] += $3 }
    $1 == "call" && $2 != $3 { calls[$2] = calls[$2] " " $3 }
    $1 == "indirect" { print "stack.sh: indirect call in " $2 > "/dev/stderr"; bad = 1 }
    function own(f) { return f in frame ? frame[f] : pushed[f] > 24 ? pushed[f] : 24 }
    function depth(f, level,    list, n, i, d, best) {
        if (f in known) return known[f]
        if (level > 50) { print "stack.sh: recursion through " f > "/dev/stderr"; bad = 1; return 0 }
        n = split(calls[f], list, " "); best = 0
        for (i = 1; i <= n; i++) { d = depth(list[i], level + 1); if (d > best) { best = d; next_of[f] = list[i] } }
        known[f] = own(f) + best
        return known[f]
    }
    END {
        for (f in frame) if (f == from || index(f, from)) start = f
        printf "%d bytes below and with %s\n", depth(start, 0), from
        for (f = start; f != ""; f = next_of[f]) printf "  %5d  %s\n", own(f), f
        exit bad
    }'

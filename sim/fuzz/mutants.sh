#!/bin/sh
# Mutants of the kernel: every operator, constant result and comparison of src/ is changed in turn, and the kernel's own tests must fail.
#
#   sim/fuzz/mutants.sh                      all of them, which takes a night
#   sim/fuzz/mutants.sh --sample SEED 8      other ones each time, for as many minutes; the seed repeats a sample
#   sim/fuzz/mutants.sh --file src/blend/layers.rs --line 162
#
# A mutant that survives is an error, and is named. Needs cargo-mutants (cargo install --locked cargo-mutants).
cd "$(dirname "$0")/../.." || exit 1
cargo mutants --version >/dev/null 2>&1 || { echo "no cargo-mutants: cargo install --locked cargo-mutants" >&2; exit 1; }
found=$(mktemp -d) || exit 1
trap 'rm -rf "$found"' EXIT
case "$1" in
--sample)
    seed=${2:?the seed} minutes=${3:?minutes}
    count=$(cargo mutants --list --line-col=false 2>/dev/null | wc -l)
    # One mutant of each shard is tried: as many shards as there are mutants, the first one by the seed.
    end=$(($(date +%s) + 60 * minutes)) tried=0 place=$((seed % count))
    echo "seed $seed: of $count mutants those from number $place on, every 89th, for $minutes minutes"
    while [ "$(date +%s)" -lt "$end" ]; do
        cargo mutants --in-place --no-shuffle --baseline=skip --timeout 120 --shard "$place/$count" --output "$found" || exit 1
        tried=$((tried + 1)) place=$(((place + 89) % count))
    done
    echo "$tried mutants tried, none survived"
    ;;
--file)
    file=${2:?a file} line=${4:?a line}
    cargo mutants --in-place --baseline=skip --timeout 120 --file "$file" --re "^$file:$line:" --output "$found"
    ;;
*) cargo mutants --baseline=skip --timeout 120 --output "$found" "$@" ;;
esac

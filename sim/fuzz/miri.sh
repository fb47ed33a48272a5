#!/bin/sh
# Runs the kernel's unit tests under Miri: every operation is interpreted and checked for undefined behaviour, overflow
# and access outside of memory. Property tests run four cases each. MIRI_SKIP lists (parts of) names of tests to leave
# out; by default those that walk through whole number ranges, which would take an interpreter hours.
#
#   sim/fuzz/miri.sh [ARGUMENTS]         all others, with arguments for the test runner: most of an hour
#   sim/fuzz/miri.sh --sample SEED 10    each tenth of them, others with the next seed
cd "$(dirname "$0")/../.." || exit 1
cargo +nightly miri --version >/dev/null 2>&1 || { echo "no Miri: rustup component add --toolchain nightly miri rust-src" >&2; exit 1; }
skips=""
slow="exhaustive seed_is_good accurate noise_is narrow_interpolator wide_ deep_stack follow_the_paper tables_ shapes_ close_everywhere short_numbers_by_words coverage_is_the_quotient ties_go_to these_words two_words_round seeds_by_words words_give_the_same rounded_sums boxes_follow spreads_are cutoffs_are_these runs_are_these"
for name in ${MIRI_SKIP-$slow}; do skips="$skips --skip $name"; done
# The property tests look for their files of regressions, so Miri lets them see the folder; and tests compare with
# powers of two from the mathematical library, which Miri otherwise disturbs on purpose.
export MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-deterministic-floats" PROPTEST_CASES=4
names=""
if [ "$1" = --sample ]; then
    # shellcheck disable=SC2086 # The list is split on purpose, as below.
    names=$(cargo +nightly miri test --locked -p splatline --lib -- --list $skips | sed -n 's/: test$//p' |
        awk -v "seed=$2" -v "of=$3" '(NR * 7 + seed) % of == 0')
    [ -n "$names" ] || { echo "no test in this sample" >&2; exit 1; }
    names="--exact $names"
    shift 3
fi
# shellcheck disable=SC2086
cargo +nightly miri test --locked -p splatline --lib -- $names $skips "$@"

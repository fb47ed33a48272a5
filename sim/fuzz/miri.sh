#!/bin/sh
# Runs the kernel's unit tests under Miri: every operation is interpreted and checked for undefined behaviour, overflow and access
# outside of memory. Property tests run four cases each. MIRI_SKIP lists (parts of) names of tests to leave out; by default those
# that walk through whole number ranges, which would take an interpreter hours. Further arguments go to the test runner.
cd "$(dirname "$0")/../.." || exit 1
cargo +nightly miri --version >/dev/null 2>&1 || { echo "no Miri: rustup component add --toolchain nightly miri rust-src" >&2; exit 1; }
skips=""
slow="exhaustive seed_is_good accurate noise_is narrow_interpolator wide_ deep_stack follow_the_paper tables_ shapes_ close_everywhere short_numbers_by_words coverage_is_the_quotient ties_go_to these_words two_words_round seeds_by_words words_give_the_same rounded_sums boxes_follow"
for name in ${MIRI_SKIP-$slow}; do skips="$skips --skip $name"; done
# The property tests look for their files of regressions, so Miri lets them see the folder; and tests compare with powers of two from
# the mathematical library, which Miri otherwise disturbs on purpose.
export MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-deterministic-floats" PROPTEST_CASES=4
# shellcheck disable=SC2086 # The list is split on purpose.
cargo +nightly miri test --locked -p splatline --lib -- $skips "$@"

#!/bin/sh
# The engine's vector code, the only unsafe code of the host, under two checkers:
#
#   sim/fuzz/vectors.sh address    its property tests with AddressSanitizer: every load, store and gather of tiles and
#                                  tables is watched
#   sim/fuzz/vectors.sh miri       its operations interpreted: undefined behaviour of every intrinsic that Miri knows
#
# PROPTEST_CASES says how many random cases each property gets. What Miri does not know (AVX-512) is drawn on arrays and
# AVX2 there.
cd "$(dirname "$0")/../.." || exit 1
cargo +nightly --version >/dev/null 2>&1 || { echo "no nightly toolchain: rustup toolchain install nightly" >&2; exit 1; }
# A target folder of its own: the flags differ from every other build's.
unset CARGO_TARGET_DIR
case "$1" in
address)
    export PROPTEST_CASES="${PROPTEST_CASES:-200}"
    # For the target alone, so that build scripts and procedural macros are compiled without.
    RUSTFLAGS="-Zsanitizer=address" cargo +nightly test --locked --target-dir sim/fuzz/target -p splatline-engine --lib \
        --target "$(rustc -vV | sed -n 's/^host: //p')" -- fast:: ;;
miri)
    cargo +nightly miri --version >/dev/null 2>&1 || { echo "no Miri: rustup component add --toolchain nightly miri rust-src" >&2; exit 1; }
    export PROPTEST_CASES="${PROPTEST_CASES:-4}"
    export MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-deterministic-floats"
    RUSTFLAGS="-Ctarget-feature=+avx2,+bmi1,+bmi2,+lzcnt,+popcnt,+fma" \
        cargo +nightly miri test --locked --target-dir sim/fuzz/target/miri -p splatline-engine --lib -- fast::lanes ;;
*) echo "address or miri?" >&2; exit 2 ;;
esac

#!/bin/sh
# Runs every fuzz target for a few seconds (first argument, default 5) from the seeds beside it, with memory limited to
# 512 MB. FUZZ_TARGETS="ply spz" runs these only. A crash is kept in artifacts/, and the exit code is 1.
#
# Debug assertions and overflow checks are on. The address sanitizer is off: the core holds no unsafe code, the host's
# lies in one folder (sim/engine/src/fast/lanes) that no target reaches, and with it the host crate's dependencies take
# several times as long to build. FUZZ_SANITIZER=address turns it on.
cd "$(dirname "$0")" || exit 1
cargo +nightly --version >/dev/null 2>&1 || { echo "no nightly toolchain: rustup toolchain install nightly" >&2; exit 1; }
cargo +nightly fuzz --version >/dev/null 2>&1 || { echo "no cargo-fuzz: cargo install --locked cargo-fuzz" >&2; exit 1; }
# A target folder of its own: the flags differ from every other build's.
unset CARGO_TARGET_DIR
flags="--fuzz-dir . --sanitizer ${FUZZ_SANITIZER:-none}"
# shellcheck disable=SC2086 # The flags are split on purpose, and no seeds are no argument.
{
    cargo +nightly fuzz build $flags || exit 1
    for target in ${FUZZ_TARGETS:-setup packet draw ply splat spz nrrd formats detached points height_field settings tables picture}; do
        mkdir -p "corpus/$target"
        seeds=""
        [ -d "seeds/$target" ] && seeds="seeds/$target"
        [ "$target" = formats ] && seeds=../reference/tests/files
        # The headers of a .ksplat alone have 5120 bytes.
        longest=2048
        case "$target" in formats | picture) longest=10240 ;; esac
        cargo +nightly fuzz run $flags "$target" "corpus/$target" $seeds -- \
            -dict=words.dict -max_total_time="${1:-5}" -max_len="$longest" -rss_limit_mb=512 -timeout=10 -print_final_stats=1 || exit 1
    done
}
echo "fuzz smoke passed"

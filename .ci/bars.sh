#!/usr/bin/env bash
# How long a stranger waits, and for how much: a fresh clone's time to the first picture and through all tests, the
# binary's size, the package. Prints a table beside the bars and fails where one is missed (.ci/weight.py does so for
# lines and words). Sources of dependencies are fetched before the clock starts.
#
#   .ci/bars.sh [FOLDER]     clones into FOLDER (default: a new one below the system's temporary folder) and removes it
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
work=${1:-$(mktemp -d)}
trap 'rm -rf "$work"' EXIT
export CARGO_TERM_COLOR=never
git clone --quiet "$root" "$work/splatline"
# The shared data lie beside the checkout where there are any.
[ -e ../shared ] && ln -s "$(cd ../shared && pwd)" "$work/shared"
cd "$work/splatline"
cargo fetch --locked --quiet

missed=0
row() { # name, value, bar
    local verdict=met
    [ "$2" -le "$3" ] || { verdict=MISSED; missed=1; }
    printf '| %-44s | %8s | %8s | %-6s |\n' "$1" "$2" "$3" "$verdict"
}
timed() { local began; began=$(date +%s); "$@" >/dev/null 2>"$work/log" || { cat "$work/log" >&2; exit 1; }; echo $(($(date +%s) - began)); }

report=$(timed cargo run --locked --release)
tests=$(timed cargo test --locked)
size=$(($(stat -c %s target/release/splatline) / 100000))
package=$(cargo package --locked --no-verify --quiet -p splatline >/dev/null 2>&1; stat -c %s target/package/splatline-*.crate)
printf 'On %s processors, load %s.\n\n' "$(nproc)" "$(cut -d' ' -f1 /proc/loadavg)"
printf '| %-44s | %8s | %8s | %-6s |\n|---|--:|--:|---|\n' what found bar ""
row "fresh clone to report (cargo run), seconds" "$report" 100
row "all tests with their compiling, seconds" "$tests" 200
row "binary, tenths of a megabyte" "$size" 150
row "package of the core, bytes" "$package" 300000
exit $missed

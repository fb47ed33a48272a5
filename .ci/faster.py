#!/usr/bin/env python3
"""How much faster whole frames have become since a commit, on one thread.

    .ci/faster.py [--rounds N] [--csv FILE] [COMMIT]

Compiles sim/engine/examples/views.rs in a worktree of COMMIT (default: the build that the bars are stated against) and
in this tree, then draws by both in turn: a ratio is of one round, and its median is held against the bar. Fails where
one is missed. Needs the scenes in ../shared/data and a machine that does nothing else.
"""
import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"
EXAMPLE = "sim/engine/examples/views.rs"

# The least ratio by level, view and design: the fastest public CPU renderer's time over ours was to grow from the first
# number to the second.
BARS = {
    ("avx2", "100k", "lean18"): 3.0 / 1.86,
    ("avx2", "guitar", "lean18"): 2.3 / 1.58,
    ("avx2", "close-up", "lean18"): 3.5 / 2.16,
    ("avx2", "stack", "lean18"): 3.5 / 1.84,
    ("avx2", "100k", "standard24"): 2.2 / 1.81,
    ("avx2", "guitar", "standard24"): 2.0 / 1.57,
    ("avx2", "1M", "standard24"): 8.0 / 5.2,
    ("avx512", "1M", "standard24"): 12.0 / 9.0,
}
SLOWER = 1.0


def build(tree):
    """Compiles the example in a tree."""
    subprocess.run(
        ["cargo", "build", "--quiet", "--release", "--locked", "-p", "splatline-engine", "--example", "views"],
        cwd=tree, check=True, env={**os.environ, "CARGO_TARGET_DIR": str(tree / "target")},
    )
    return tree / "target/release/examples/views"


def times(program, level):
    """Milliseconds by view and design."""
    printed = subprocess.run([program, level, DATA], capture_output=True, text=True, check=True).stdout
    rows = [line.split(",") for line in printed.splitlines()[1:]]
    return {(view, design): float(milliseconds) for view, design, milliseconds in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit", nargs="?", default="7ca1d44a")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--csv", type=pathlib.Path, help="also write the table there")
    options = parser.parse_args()
    if not DATA.is_dir():
        raise SystemExit(f"{DATA} has the scenes that are drawn, and is not there")
    levels = ["avx2"]
    if "avx512f" in pathlib.Path("/proc/cpuinfo").read_text():
        levels.append("avx512")
    with tempfile.TemporaryDirectory() as folder:
        before = pathlib.Path(folder) / "before"
        subprocess.run(["git", "worktree", "add", "--quiet", "--detach", before, options.commit], cwd=ROOT, check=True)
        try:
            (before / EXAMPLE).parent.mkdir(exist_ok=True)
            shutil.copy(ROOT / EXAMPLE, before / EXAMPLE)
            programs = [build(before), build(ROOT)]
            rounds = {
                level: [[times(program, level) for program in programs] for _ in range(options.rounds)]
                for level in levels
            }
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", before], cwd=ROOT, check=True)
    missed = False
    table = ["level,view,design,before,now,ratio,least,most,bar"]
    for level, measured in rounds.items():
        for key in measured[0][1]:
            old, new = ([pair[which][key] for pair in measured] for which in (0, 1))
            ratios = [a / b for a, b in zip(old, new)]
            bar = BARS.get((level, *key), SLOWER)
            missed |= statistics.median(ratios) < bar
            before, now, ratio = (statistics.median(values) for values in (old, new, ratios))
            table.append(",".join([level, *key, f"{before:.1f},{now:.1f},{ratio:.2f}",
                                   f"{min(ratios):.2f},{max(ratios):.2f},{bar:.2f}"]))
    print("\n".join(table))
    if options.csv:
        options.csv.write_text("\n".join(table) + "\n")
    raise SystemExit(missed)


if __name__ == "__main__":
    main()

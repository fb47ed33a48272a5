#!/usr/bin/env python3
"""What each direct dependency of the host costs: seconds to compile, alone and with all that it brings, and bytes of code in the program.

    .ci/dependencies.py

Builds the program anew with one job, so that no two crates share the clock. A crate that several bring counts for each of them. A function counts
for the crate that it is named after, generic ones too."""

import collections
import json
import os
import re
import subprocess
import tempfile

PACKAGES = ["splatline-sim", "splatline-machine", "splatline-engine", "splatline-reference", "splatline"]


def output(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


def seconds(target):
    page = open(f"{target}/cargo-timings/cargo-timing.html").read()
    units = json.loads(re.search(r"UNIT_DATA = (\[.*?\]);\n", page, re.S).group(1))
    times = collections.Counter()
    for unit in units:
        times[unit["name"]] += unit["duration"]
    return times


def code(program):
    sizes = collections.Counter()
    for line in output("nm", "-C", "-S", "--radix=d", program).splitlines():
        parts = line.split(None, 3)
        if len(parts) == 4 and parts[2] in "tT":
            crate = re.match(r"[<&(\[]*(?:mut )?(?:dyn )?(\w+)", parts[3])
            sizes[crate.group(1) if crate else ""] += int(parts[1])
    return sizes


def tree(package, *options):
    """Names and versions of what a package brings, itself included."""
    lines = output("cargo", "tree", "--locked", "-e", "normal", "--prefix", "none", "-p", package, *options).splitlines()
    return {line.split()[0]: line.split()[1].lstrip("v") for line in lines if line}


def brought(name, version):
    return set(tree(f"{name}@{version}"))


def direct():
    for package in json.loads(output("cargo", "metadata", "--locked", "--no-deps", "--format-version", "1"))["packages"]:
        if package["name"] in PACKAGES:
            for dependency in package["dependencies"]:
                if dependency["kind"] is None and not dependency["optional"] and dependency["name"] not in PACKAGES:
                    yield dependency["name"]


def main():
    os.chdir(os.path.join(os.path.dirname(__file__), ".."))
    with tempfile.TemporaryDirectory() as target:
        environment = os.environ | {"CARGO_PROFILE_RELEASE_STRIP": "false", "CARGO_TARGET_DIR": target}
        command = "cargo build --locked --release --jobs 1 --timings -p splatline-sim --bin splatline"
        subprocess.run(command.split(), check=True, env=environment)
        times, sizes = seconds(target), code(f"{target}/release/splatline")
    print("| crate | seconds, alone | with what it brings | code, KB |\n|---|--:|--:|--:|")
    versions = {name: version for package in PACKAGES for name, version in tree(package, "--depth", "1").items()}
    for name in sorted(set(direct()) & set(versions)):
        all_of_them = brought(name, versions[name])
        total = sum(times[each] for each in all_of_them)
        own_code = sum(sizes[each.replace("-", "_")] for each in all_of_them) / 1000
        print(f"| `{name}` | {times[name]:.1f} | {total:.1f} | {own_code:.0f} |")
    everything = sum(times.values())
    print(f"\nAll {len(times)} crates: {everything:.0f} s with one job; ours: " + ", ".join(f"{each} {times[each]:.0f} s" for each in PACKAGES) + ".")


main()

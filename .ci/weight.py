#!/usr/bin/env python3
"""How heavy the tree is: lines of Rust by folder, pages and words. Prints a table beside the bars, and fails where one is missed.

    .ci/weight.py

A file's tests do not count among "without tests": folders tests and benches, files named test(s).rs or *_test(s).rs, and what stands behind the
first inline `#[cfg(test)] mod name {`. Prose is what a page has outside of tables and indented blocks."""

import collections
import os
import re
import subprocess
import sys

TESTS = re.compile(r"(^|/)(tests|benches)/|tests?\.rs$")


def lines(path):
    with open(path, errors="replace") as file:
        return file.read().split("\n")


def without_tests(path, text):
    if TESTS.search(path):
        return 0
    for number, line in enumerate(text[:-1]):
        if line.strip() == "#[cfg(test)]" and re.match(r"\s*mod \w+ \{", text[number + 1]):
            return number
    return len(text) - 1


def folder(path):
    parts = path.split("/")
    if parts[0] != "sim" or parts[1] in ("src", "tests"):
        return "/".join(parts[: 1 + (parts[0] == "sim")])
    return "/".join(parts[:2])


def main():
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    files = subprocess.run(["git", "ls-files"], check=True, capture_output=True, text=True).stdout.split()
    every, code = collections.Counter(), collections.Counter()
    for path in (path for path in files if path.endswith(".rs")):
        text = lines(path)
        every[folder(path)] += len(text) - 1
        code[folder(path)] += without_tests(path, text)
    print("| folder | Rust, all | without tests |\n|---|--:|--:|")
    for name in sorted(every):
        print(f"| {name} | {every[name]:,} | {code[name]:,} |")
    pages = [path for path in files if path.startswith("docs/") and path.endswith(".md")]
    by_hand = [path for path in pages if "/results/" not in path and "/gallery/" not in path]
    prose = sum(len(line.split()) for path in by_hand for line in lines(path) if not line.startswith(("|", "    ")))
    words = sum(len(line.split()) for path in pages for line in lines(path))
    missed = False
    print("\n| what | found | bar | |\n|---|--:|--:|---|")
    for what, found, bar in [
        ("Rust outside the kernel, without tests", sum(code[name] for name in code if name.startswith("sim")), 60_000),
        ("all Rust", sum(every.values()), 92_000),
        ("the documentation's own program, without tests", code["sim/docs"], 3_000),
        ("co-simulation, without tests", code["sim/rtl"], 7_500),
        ("pages by hand", len(by_hand), 22),
        ("their prose, words", prose, 20_000),
        ("all words of pages, tables included", words, 50_000),
    ]:
        print(f"| {what} | {found:,} | {bar:,} | {'met' if found <= bar else 'MISSED'} |")
        missed |= found > bar
    sys.exit(missed)


main()

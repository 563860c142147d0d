#!/usr/bin/env python3
"""Lists the code that no test ran, from the output of `llvm-cov show -show-branches=count`.

    llvm-cov show ... | uncovered_code.py ROOT

ROOT is the checkout with a slash at its end; file names are printed relative to it. Two lists follow each other: the branches
of which one side was never taken, as FILE:LINE:COLUMN, and the lines that were never run, as FILE:FIRST-LAST. Code of a
template counts as run if one of its instances ran it.
"""
import collections
import re
import sys

SOURCE = re.compile(r"^\s*(\d+)\|\s*([\d.]+[a-zA-Z]?)?\|(.*)$")
BRANCH = re.compile(r"^\s*\|\s*Branch \((\d+):(\d+)\): \[True: ([^,]+), False: ([^\]]+)\]")


def is_positive(count):
    """Returns whether a count is above 0. llvm-cov abbreviates counts, such as 1.2k."""
    return count.strip() != "0"


class Report:
    """Parsed output of llvm-cov."""

    def __init__(self, text, root):
        self.lines = {}  # source lines by (file, line)
        self.ran = {}  # by (file, line): whether an instance ran it
        self.sides = collections.defaultdict(lambda: [False, False])  # by (file, line, column): true, false
        file = ""
        for line in text:
            line = line.rstrip("\n")
            if line.startswith("/") and line.endswith(":"):
                file = line[:-1].removeprefix(root)
            elif branch := BRANCH.match(line):
                sides = self.sides[file, int(branch[1]), int(branch[2])]
                for side in (0, 1):
                    sides[side] |= is_positive(branch[3 + side])
            elif source := SOURCE.match(line):
                place = (file, int(source[1]))
                self.lines[place] = source[3].strip()
                if source[2] is not None:
                    self.ran[place] = self.ran.get(place, False) or is_positive(source[2])

    def print_branches(self):
        for (file, line, column), (true, false) in sorted(self.sides.items()):
            if true != false:
                side = "false" if true else "true"
                print(f"{file}:{line}:{column}: never {side}: {self.lines.get((file, line), '')}")

    def print_lines(self):
        never = sorted(place for place, ran in self.ran.items() if not ran)
        ranges = []
        for file, line in never:
            if ranges and ranges[-1][0] == file and ranges[-1][2] == line - 1:
                ranges[-1][2] = line
            else:
                ranges.append([file, line, line])
        for file, first, last in ranges:
            print(f"{file}:{first}-{last}: never run: {self.lines[file, first]}")


def main(words):
    if len(words) != 1:
        sys.exit("uncovered_code.py ROOT")
    report = Report(sys.stdin, words[0])
    report.print_branches()
    report.print_lines()


if __name__ == "__main__":
    main(sys.argv[1:])

#!/usr/bin/env python3
"""Lists the branches that no test took, from the output of `llvm-cov show -show-branches=count`.

    llvm-cov show ... | uncovered_branches.py ROOT

Prints FILE:LINE and the side that was never taken, with the source line. A template or a kernel that is compiled for
several instruction sets has several instances; a branch counts as taken if any instance took it. Lines that no test
reached at all are listed by the report, not here.
"""
import collections
import re
import sys

SOURCE = re.compile(r"^\s*(\d+)\|\s?(.*)$")
BRANCH = re.compile(r"^\s*\|\s*Branch \((\d+):(\d+)\): \[True: ([^,]+), False: ([^\]]+)\]")


def count_of(text):
    """llvm-cov abbreviates counts, such as 1.2k; only zero matters here."""
    return 0 if text.strip() == "0" else 1


def main(root):
    name, lines = "", {}
    taken = collections.defaultdict(lambda: [0, 0])
    for text in sys.stdin:
        text = text.rstrip("\n")
        if text.startswith("/") and text.endswith(":"):
            name = text[:-1].removeprefix(root)
        elif found := BRANCH.match(text):
            place = (name, int(found[1]), int(found[2]))
            for side in (0, 1):
                taken[place][side] += count_of(found[3 + side])
        elif found := SOURCE.match(text):
            lines[name, int(found[1])] = found[2].strip()
    for (file, line, column), (true, false) in sorted(taken.items()):
        if bool(true) != bool(false):
            side = "false" if true else "true"
            print(f"{file}:{line}:{column}: never {side}: {lines.get((file, line), '')}")


if __name__ == "__main__":
    main(sys.argv[1])

#!/usr/bin/env python3
"""Writes tables of results into pages: the text between <!-- begin NAME --> and <!-- end NAME -->.

    bench/page.py [--check] [RESULTS PAGE...]      default: docs/results, and the pages that have such marks

RESULTS: the folder that bench/results fills. bench/tables.py makes the text of each NAME. Text outside the marks stays unchanged. With
--check no page is written; the exit status is 1 if a page would change, or if the results are not those of one commit and machine.
"""
import pathlib
import re
import sys

import origin
from tables import BLOCKS

BLOCK = re.compile(r"<!-- begin (\w+) -->\n.*?<!-- end \1 -->", re.DOTALL)


def pages_with_blocks():
    pages = [origin.ROOT / "README.md", *sorted((origin.ROOT / "docs").rglob("*.md"))]
    return [page for page in pages if BLOCK.search(page.read_text(encoding="utf-8"))]


def fill(page, results):
    """Returns the page with every block rewritten."""
    return BLOCK.sub(lambda match: f"<!-- begin {match[1]} -->\n{BLOCKS[match[1]](results)}\n<!-- end {match[1]} -->", page)


def main(words):
    check = words[:1] == ["--check"]
    if len(words) - check == 1:
        sys.exit("page.py [--check] [RESULTS PAGE...]")
    results, *pages = map(pathlib.Path, words[check:]) if len(words) > check else [origin.ROOT / "docs" / "results", *pages_with_blocks()]
    errors = origin.differences(sorted(results.glob("*.json"))) if check else []
    for page in pages:
        before = page.read_text(encoding="utf-8")
        after = fill(before, results)
        if check and after != before:
            errors.append(f"{page}: a table differs from {results}: run bench/page.py")
        elif after != before:
            page.write_text(after, encoding="utf-8")
    for error in errors:
        print(error, file=sys.stderr)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""Lists the failures that no test reached, from the output of `llvm-cov export`.

    llvm-cov export -skip-functions -skip-expansions ... | unreached_failures.py ROOT LIST

A failure is a `throw`, a call of a function that is [[noreturn]], or a block of `catch`. ROOT is the checkout. LIST is a file with
the failures to leave out, one in a line of the form "FILE: CODE", where CODE is the line of the source, below comments with their reasons.
Prints the others as FILE:LINE: CODE, then the entries of LIST that are out of date, because a test reaches the failure or the line is
gone. The exit status is 1 if there are any.
"""
import bisect
import collections
import json
import pathlib
import re
import sys

# Comments, strings and characters.
NO_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'', re.DOTALL)
NORETURN = re.compile(r"\[\[noreturn\]\][^;{(]*?(\w+)\(")
ENTRY = re.compile(r"^([^#:]+): (.+)$")


def code_of(text):
    """Returns a source with blanks in place of comments, strings and characters. All other code keeps its place."""
    return NO_CODE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


class Source:
    """A file, and how often its parts ran."""

    def __init__(self, text, segments):
        self.lines = text.splitlines()
        self.code = code_of(text)
        self.begins = [0]
        for line in text.split("\n"):
            self.begins.append(self.begins[-1] + len(line) + 1)
        # A segment is: line, column, count, whether it has a count, ...; it lasts until the next one.
        self.places = [(segment[0], segment[1]) for segment in segments]
        self.counts = [segment[2] if segment[3] else None for segment in segments]

    def line_of(self, place):
        return bisect.bisect_right(self.begins, place)

    def count(self, place):
        """Returns how often the code at a place of the text ran; None if it was not compiled, such as a declaration."""
        line = self.line_of(place)
        segment = bisect.bisect_right(self.places, (line, place - self.begins[line - 1] + 1)) - 1
        return self.counts[segment] if segment >= 0 else None

    def failures(self, functions):
        """Returns the places of all failures."""
        places = [match.start() for match in re.finditer(rf"\bthrow\b|\b(?:{'|'.join(functions)})\(", self.code)]
        places += [match.end() for match in re.finditer(r"\bcatch \([^{]*\{", self.code)]
        return places


def read_sources(report, root):
    """Returns the sources of the library, the program and the Python package in a report of llvm-cov, by their paths below ROOT."""
    sources = {}
    for data in report["data"]:
        for file in data["files"]:
            path = pathlib.Path(file["filename"])
            if path.is_relative_to(root) and path.relative_to(root).parts[0] in ("src", "python", "c"):
                sources[str(path.relative_to(root))] = Source(path.read_text(), file["segments"])
    return sources


def main(words):
    if len(words) != 2:
        sys.exit("unreached_failures.py ROOT LIST")
    root = pathlib.Path(words[0]).resolve()
    listed = {(match[1], match[2]) for line in pathlib.Path(words[1]).read_text().splitlines() if (match := ENTRY.match(line))}
    sources = read_sources(json.load(sys.stdin), root)
    functions = sorted({match[1] for source in sources.values() for match in NORETURN.finditer(source.code)})
    unreached = collections.defaultdict(set)
    failures = missed = 0
    for path, source in sorted(sources.items()):
        for place in sorted(source.failures(functions)):
            count = source.count(place)
            failures += count is not None
            missed += count == 0
            if count == 0:
                line = source.line_of(place)
                unreached[path, source.lines[line - 1].strip()].add(line)
    if failures == 0:
        sys.exit("no source of this checkout is in the report")
    unlisted = set(unreached) - listed
    for path, code in sorted(unlisted):
        print(f"{path}:{','.join(map(str, sorted(unreached[path, code])))}: {code}")
    for path, code in sorted(listed - set(unreached)):
        print(f"{words[1]}: out of date: {path}: {code}")
    print(f"{failures} failures; tests reach {failures - missed} of them")
    sys.exit(1 if unlisted or listed - set(unreached) else 0)


if __name__ == "__main__":
    main(sys.argv[1:])

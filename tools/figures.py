#!/usr/bin/env python3
"""Checks the figures in pages and public headers: every number with a unit is in tools/figure_table.py.

    figures.py [--write] [ROOT]     ROOT: the project's directory; default: the parent of tools/

A number with a unit is a time, an amount of memory, a ratio or a share, in digits or in words. It must stand in a phrase of
the table, with the value that the table computes from docs/results or reads from a source. Numbers of table cells count if
the head of their column has a unit.

Not scanned: blocks that bench/page.py writes, code, sample outputs, and the files below. --write replaces measured
values that differ. Prints one line for each fault, and exits 1.
"""
import ast
import bisect
import pathlib
import re
import sys

import figure_table
from figure_table import Constant, Measured, Stated

SCANNED = ["README.md", "HACKING.md", "CONTRIBUTING.md", "docs/**/*.md", "include/**/*.hpp", "c/include/**/*.h",
           "adapters/*/include/**/*.hpp", "python/octopair/*.py"]
# Layouts and fields, which tests compare with the code.
NOT_SCANNED = ["docs/formats.md", "docs/protocol.md",
               "docs/results/sixteen-cores.md"]  # measured once, at the commit that it names
DIGITS = r"\d[\d,]*(?:\.\d+)?(?:e-?\d+)?"
WORDS = "one two three four five six seven eight nine ten eleven twelve".split()
LARGE_WORDS = "fifteen twenty thirty forty fifty sixty ninety hundred thousand".split()
PARTS = ["half", "third", "quarter", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth", "sixteenth", "hundredth", "thousandth"]
SHARE = rf"(?:an?|{'|'.join(WORDS)})\s(?:{'|'.join(PARTS)})s?"
VALUE = rf"(?:{SHARE}|half|{DIGITS}/\d[\d^]*|{DIGITS}(?:\sto\s{DIGITS})?%?|{'|'.join(WORDS)}|an?)"
TIME = r"(?:[num]?s|(?:nano|micro|milli)?seconds?|minutes?|hours?|days?)"
MEMORY = r"(?:(?:kilo|mega|giga|tera|kibi|mebi|gibi)?bytes?|[kMGT]i?B)"
EACH = "(?:object|pair|entry|octant|box|index|proxy|triangle|million|rank|worker|core|row|second|minute|frame)"
UNIT = rf"(?:{TIME}|{MEMORY}|x|times|per\s?cent|(?:(?:more\s)?per|an?|for\seach)\s{EACH}|(?:for|in)\sfloat64)(?![\w(^])"
# "a second" is a time behind these words, and elsewhere the second of something.
AFTER = "(?:" + "|".join(rf"(?<={word}\s)" for word in ("within", "after", "most", "about", "takes", "for", "than", "every")) + ")"
QUANTITY = re.compile(
    rf"(?<![\w.^])(?:{DIGITS}\s?(?:%|{UNIT}(?!\s?\d))"
    rf"|(?:{'|'.join([*WORDS, *LARGE_WORDS])})[\s-](?:{TIME}|{MEMORY}|times)(?!\w)"
    rf"|{SHARE}(?=\s(?:of|as|longer|shorter|less|more|that)\b|[.,;:)]|$)|half\s(?:of|the|as|an?|are|that|to)\b|half$"
    rf"|twice\s(?:as|the|that|more|longer)\b"
    rf"|(?<![\w/])\d+/\d+(?:\^\d+)?(?![\w/])"
    rf"|{AFTER}an?\s(?:second|millisecond|microsecond)\b|an?\s(?:minute|hour|day|{MEMORY})\b)")
UNIT_IN_HEAD = re.compile(rf"\b(?:{TIME}|{MEMORY}|times)\b(?!\))")


def blanked(text, spans):
    """Returns the text with spaces in place of the spans. Line ends stay."""
    parts, at = [], 0
    for begin, end in sorted(spans):
        if end > at:
            parts += [text[at:max(at, begin)], re.sub(r"[^\n]", " ", text[max(at, begin):end])]
            at = end
    return "".join(parts) + text[at:]


def lines_with_offsets(text):
    at = 0
    for line in text.splitlines(keepends=True):
        yield at, line
        at += len(line)


def code_spans(text):
    """Yields the spans of generated blocks, fenced and indented code, and comments of a Markdown page."""
    for pattern in (r"<!-- begin (\w+) -->.*?<!-- end \1 -->", r"<!--.*?-->", r"^ *```.*?^ *```"):
        yield from (match.span() for match in re.finditer(pattern, text, re.S | re.M))
    code, after_blank = False, True
    for at, line in lines_with_offsets(text):
        code = line.startswith("    ") and (code or after_blank) or code and not line.strip()
        after_blank = not line.strip()
        if code:
            yield at, at + len(line)


def docstring_spans(text):
    """Yields the spans of the lines with docstrings of a Python file."""
    starts = [at for at, _ in lines_with_offsets(text)]
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node, clean=False) is not None:
            value = node.body[0].value
            yield starts[value.lineno - 1], starts[value.end_lineno] if value.end_lineno < len(starts) else len(text)


def prose(path, text):
    """Returns the text of a file in which everything that is not scanned is blank."""
    if path.endswith(".md"):
        return blanked(text, code_spans(text))
    if path.endswith(".py"):
        kept = sorted(docstring_spans(text))
        ends = [0, *(end for _, end in kept)]
        return blanked(text, zip(ends, [*(begin for begin, _ in kept), len(text)]))
    comment = re.compile(r"(?<!:)//[/!]?<? ?")
    spans = []
    for at, line in lines_with_offsets(text):
        match = comment.search(line)
        spans.append((at, at + (match.end() if match else len(line))))
    return blanked(text, spans)


def overlap(span, spans):
    return any(span[0] < end and begin < span[1] for begin, end in spans)


class Page:
    """A file with its prose in one line of words with single spaces. Positions in that line lead back to the file."""

    def __init__(self, path, text):
        self.path, self.text = path, text
        shown = prose(path, text)
        words = [(match.start(), match[0]) for match in re.finditer(r"\S+", shown)]
        self.line = " ".join(word for _, word in words)
        self.offsets = [offset for offset, _ in words]
        self.starts = []
        at = 0
        for _, word in words:
            self.starts.append(at)
            at += len(word) + 1
        # Code within a line and targets of links have no quantities.
        hidden = re.sub(r"`[^`]*`|\]\([^)]*\)", lambda match: re.sub(r"[^\s]", "·", match[0]), self.line)
        self.quantities = [match.span() for match in QUANTITY.finditer(hidden)]
        if path.endswith(".md"):
            self.quantities += self.cells(shown)

    def cells(self, shown):
        """Returns the numbers in the columns of tables whose head has a unit."""
        found, units = [], None
        for at, line in lines_with_offsets(shown):
            if not line.startswith("|"):
                units = None
                continue
            cells = [(match.start(), match[0]) for match in re.finditer(r"[^|\n]+", line)]
            if units is None:
                units = [bool(UNIT_IN_HEAD.search(cell)) for _, cell in cells]
                continue
            for unit, (begin, cell) in zip(units, cells):
                match = re.match(rf"\s(?:(?:at most|about|up to) )?({DIGITS})", cell)
                if unit and match:
                    found.append(tuple(self.position(at + begin + where) for where in match.span(1)))
        return found

    def position(self, offset):
        """Returns the position in the line of words of an offset in the file."""
        word = bisect.bisect_right(self.offsets, offset) - 1
        return self.starts[word] + offset - self.offsets[word]

    def offset(self, position):
        """Returns the offset in the file of a position in the line of words."""
        word = bisect.bisect_right(self.starts, position) - 1
        return self.offsets[word] + position - self.starts[word]

    def number(self, position):
        """Returns the number of the file's line."""
        return self.text.count("\n", 0, self.offset(position)) + 1


def spellings(value):
    """Returns how a page may write a value: in digits, in words, or as a share."""
    if isinstance(value, str):
        return {value}
    texts = {f"{value.numerator:,}" if value.denominator == 1 else f"{float(value):.10g}"}
    if value.denominator == 1 and 1 <= value <= len(WORDS):
        texts |= {WORDS[int(value) - 1]} | ({"a", "an"} if value == 1 else set())
    if value < 1:
        texts |= {f"{float(value * 100):g}%", f"{value.numerator}/{value.denominator}"}
        names = dict(zip([2, 3, 4, 5, 6, 7, 8, 9, 10, 16, 100, 1000], PARTS))
        if value.denominator in names:
            name, many = names[value.denominator], ["", "a", "two", "three"]
            texts |= {name} if name == "half" else set()
            if value.numerator < len(many):
                word = many[value.numerator]
                texts.add(f"{'an' if name == 'eighth' else word} {name}{'s' if value.numerator > 1 else ''}")
    return texts


class Phrase:
    """A phrase of a figure, with a pattern that has the value as its group."""

    def __init__(self, text, figure, values):
        self.text, self.figure, self.values = text, figure, values
        self.parts = text.split("{}")
        escaped = [re.escape(part) for part in self.parts]
        inner = f"({VALUE})".join(escaped) if len(escaped) > 1 else f"({escaped[0]})"
        begin = r"(?<!\w)" if re.match(r"[\w{]", text) else ""
        end = r"(?!\w)(?![.,]\d)" if re.search(r"[\w}]$", text) else ""
        self.pattern = re.compile(begin + inner + end)
        self.used = False

    def matches(self, page):
        """Yields the span of the value, and whether the value is right."""
        if all(part in page.line for part in self.parts):
            for match in self.pattern.finditer(page.line):
                right = self.values is None or match[1] in self.values
                self.used = self.used or right
                yield match.span(1), right


def phrases(root):
    """Returns the phrases of the table, and the faults of sources without the constant that the table reads."""
    made, faults = [], []
    for figure in figure_table.figures():
        if isinstance(figure, Stated):
            values = None
        else:
            try:
                values = spellings(figure.value(root))
            except (OSError, LookupError, ValueError, StopIteration) as error:
                faults.append(f"{figure.source}: figure '{figure.name}': {error}: correct tools/figure_table.py")
                continue
        made += [Phrase(text, figure, values) for text in figure.phrases]
    return made, faults


def complaints(page, all_phrases):
    """Yields (span of the number, phrase or None, fault) for each fault of a page."""
    right, wrong = [], []
    for phrase in all_phrases:
        for span, is_right in phrase.matches(page):
            (right if is_right else wrong).append((span, phrase))
    good = [span for span, _ in right]
    for span, phrase in wrong:
        if not overlap(span, good):
            figure = phrase.figure
            what = " or ".join(sorted(phrase.values))
            todo = "run tools/figures.py --write" if isinstance(figure, Measured) else f"correct this text, or {figure.source}"
            text = phrase.text.replace("{}", page.line[slice(*span)])
            yield span, phrase, f"'{text}': figure '{figure.name}' of {figure.source} is {what}: {todo}"
    known = good + [span for span, _ in wrong]
    for span in page.quantities:
        if not any(begin <= span[0] < end for begin, end in known):
            text = page.line[max(0, span[0] - 20):span[1] + 20]
            yield span, None, (f"'{page.line[slice(*span)]}' (in '{text}') is no figure of tools/figure_table.py: add one, or say it "
                               "without a number")


def load(root):
    """Returns the texts of the scanned files by their paths."""
    found = {}
    for pattern in SCANNED:
        for path in sorted(root.glob(pattern)):
            name = path.relative_to(root).as_posix()
            if name not in NOT_SCANNED:
                found[name] = path.read_text(encoding="utf-8")
    return found


def check(texts, root):
    """Returns the faults of the files, and their texts with right measured values."""
    all_phrases, faults = phrases(root)
    mended = dict(texts)
    for path, text in texts.items():
        page = Page(path, text)
        found = sorted(complaints(page, all_phrases), key=lambda complaint: complaint[0])
        faults += [f"{path}:{page.number(span[0])}: {fault}" for span, _, fault in found]
        for span, phrase, _ in reversed(found):
            if phrase and isinstance(phrase.figure, Measured):
                begin, end = page.offset(span[0]), page.offset(span[1] - 1) + 1
                mended[path] = mended[path][:begin] + min(phrase.values) + mended[path][end:]
    faults += [f"tools/figure_table.py: no page has the phrase '{phrase.text}': remove the phrase" for phrase in all_phrases
               if not phrase.used and not faults]
    return faults, mended


def main(words):
    write = "--write" in words
    roots = [word for word in words if word != "--write"]
    root = pathlib.Path(roots[0] if roots else pathlib.Path(__file__).parents[1]).resolve()
    texts = load(root)
    faults, mended = check(texts, root)
    if write:
        changed = [path for path in texts if mended[path] != texts[path]]
        for path in changed:
            (root / path).write_text(mended[path], encoding="utf-8")
            print(f"wrote {path}")
        faults, _ = check(mended, root)
    print("\n".join(faults) or f"all figures of {len(texts)} files are those of their sources")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

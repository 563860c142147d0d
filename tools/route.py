#!/usr/bin/env python3
"""Checks docs/route.md, the route of a search: each file and each function that it names exists.

    route.py [ROOT]     ROOT: the project's directory; default: the parent of tools/

Paths on the page begin in src/. In a table with the columns "file" and "function", the function must be in the file of its row, or in
the file that its own cell names. Any other name in code style must be in some file of src/ or include/. The page has at most two screens.
Prints one line for each fault, and exits 1.
"""
import pathlib
import re
import sys

PAGE = "docs/route.md"
MOST_LINES = 100  # two screens
CODE_SPAN = re.compile(r"`([^`]+)`")
FILE_NAME = re.compile(r"^[\w./-]+\.[ch]pp$")
NAME = re.compile(r"^[A-Za-z_]\w*(::[A-Za-z_]\w*)*(\(\))?$")


def cells_of(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def words_of(text):
    return set(re.findall(r"\w+", text))


class Page:
    def __init__(self, root):
        self.root = root
        self.lines = (root / PAGE).read_text(encoding="utf-8").splitlines()
        sources = [path for folder in ("src", "include") for path in (root / folder).rglob("*.[ch]pp")]
        self.all_words = set().union(*(words_of(path.read_text(encoding="utf-8")) for path in sources)) if sources else set()
        self.names = 0

    def words_of_files(self, files):
        return set().union(*(words_of((self.root / "src" / file).read_text(encoding="utf-8")) for file in files))

    def complaints_of_line(self, line, columns):
        """Yields the faults of a line. `columns`: the header of its table, or none."""
        spans = CODE_SPAN.findall(line)
        absent = [span for span in spans if FILE_NAME.match(span) and not (self.root / "src" / span).is_file()]
        yield from (f"no file src/{file}" for file in absent)
        if absent:
            return
        functions = []
        if "file" in columns and "function" in columns:
            cells = cells_of(line)
            cell = cells[columns.index("function")]
            functions = [span for span in CODE_SPAN.findall(cell) if NAME.match(span)]
            files = [span for span in CODE_SPAN.findall(cells[columns.index("file")] + cell) if FILE_NAME.match(span)]
            there = self.words_of_files(files)
            for name in functions:
                for part in name.removesuffix("()").split("::"):
                    if part not in there:
                        yield f"{name} is not in {' or '.join(files)}"
        for name in spans:
            if NAME.match(name):
                self.names += 1
                if name not in functions and not set(name.removesuffix("()").split("::")) <= self.all_words:
                    yield f"{name} is in no file"

    def complaints(self):
        if len(self.lines) > MOST_LINES:
            yield f"{PAGE}: {len(self.lines)} lines; at most {MOST_LINES}"
        columns = []
        for number, line in enumerate(self.lines, 1):
            if not line.startswith("|"):
                columns = []
            elif not columns:
                columns = cells_of(line)
            yield from (f"{PAGE}:{number}: {fault}" for fault in self.complaints_of_line(line, columns if "`" in line else []))
        if self.names == 0:
            yield f"{PAGE}: it names no function"


def main():
    page = Page(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve())
    complaints = list(page.complaints())
    print("\n".join(complaints) if complaints else f"{page.names} names are where the page says")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())

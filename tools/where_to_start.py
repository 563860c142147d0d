#!/usr/bin/env python3
"""Checks the table "Where to start" of HACKING.md: its files exist, and each file of its second column begins by saying so.

    where_to_start.py [ROOT]     ROOT: the project's directory; default: the parent of tools/

A row `| when an octant is split | `FILE` | ... |` needs the line `// Start here to change when an octant is split.` in the head
of FILE. In a row that begins with "a new", the word is "add" in place of "change". A file name of the third column without
a folder is a file beside FILE. No other file may have such a line. Prints one line for each fault, and exits 1.
"""
import pathlib
import re
import sys

FOLDERS = ["include", "src", "c", "python", "adapters", "viewer/page"]
CODE_SPAN = re.compile(r"`([^`]+)`")
FILE_NAME = re.compile(r"^[\w./-]+\.(hpp|cpp|h|py|proto|ts|toml|md|1)$")
START = re.compile(r"^// (Start here to .*\.)$")
LONGEST_HEAD = 5  # lines in which the sentence stands


def sentence_of(task):
    task = task.replace("`", "")
    return f"Start here to {'add' if task.startswith('a new ') else 'change'} {task}."


def rows_of(root):
    """Yields (line number, cells) for each row of the table."""
    lines = (root / "HACKING.md").read_text(encoding="utf-8").splitlines()
    begin = lines.index("## Where to start") + 1 if "## Where to start" in lines else len(lines)
    for number, line in enumerate(lines[begin:], begin + 1):
        if line.startswith("## "):
            return
        if line.startswith("|") and "`" in line:
            yield number, [cell.strip() for cell in line.strip("|").split("|")]


def starts_of(root):
    """Returns the sentence of each file that begins with one, by path."""
    found = {}
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp", ".h", ".proto", ".ts"):
                for line in path.read_text(encoding="utf-8").splitlines()[:LONGEST_HEAD]:
                    if match := START.match(line):
                        found[str(path.relative_to(root))] = match[1]
    return found


def complaints_of(root):
    starts = starts_of(root)
    named = set()
    for number, cells in rows_of(root):
        task, start = cells[0], cells[1].strip("`")
        named.add(start)
        if not (root / start).is_file():
            yield f"HACKING.md:{number}: no file {start}"
        elif starts.get(start) != sentence_of(task):
            yield f"{start}:1: the head lacks '// {sentence_of(task)}' (HACKING.md:{number})"
        for name in filter(FILE_NAME.match, CODE_SPAN.findall(" ".join(cells[2:]))):
            if not (root / name).is_file() and not (root / start).parent.joinpath(name).is_file():
                yield f"HACKING.md:{number}: no file {name}"
    if not named:
        yield "HACKING.md: no table 'Where to start'"
    for path in sorted(starts.keys() - named):
        yield f"{path}:1: HACKING.md does not name this file, which says '{starts[path]}'"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    complaints = list(complaints_of(root))
    print("\n".join(complaints) if complaints else f"{len(list(rows_of(root)))} tasks have a file that says so")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())

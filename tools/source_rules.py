#!/usr/bin/env python3
"""Checks the rules of HACKING.md that neither compiler, clang-format nor clang-tidy checks.

    source_rules.py [ROOT]     ROOT: the project's directory; default: the parent of tools/

Prints one line for each violation, and exits 1.
"""
import ast
import pathlib
import re
import sys

FOLDERS = ["include", "src", "c", "python", "bench", "tests", "examples", "tools", "cmake", "scripts", "docs"]
CODE = {".hpp", ".cpp"}
TEXT = CODE | {".py", ".cmake", ".txt", ".md", ".sh", ".in", ""}
LONGEST_FILE = 800
SNAKE_CASE = re.compile(r"^[a-z][a-z0-9_]*$")

# Name of a violation, and pattern of a line with it.
EVERYWHERE = [
    ("unfinished work is not committed", re.compile(r"\b(TODO|FIXME|XXX)\b")),
    ("a path of someone's machine", re.compile(r"(?<![\w.$}/-])/(home|root|work|Users)/\w")),
]
IN_CODE = [
    ("code that is switched off", re.compile(r"^\s*#\s*if\s+0\b")),
    ("a banner", re.compile(r"^\s*//\s*[-=*/#]{4,}")),
    ("commented-out code", re.compile(r"^\s*//\s*(return\b.*|[\w:<>*&. ]+\(.*\)|[\w.:<>\[\]* ]+ = .*);\s*$")),
]
IN_LIBRARY = [
    ("the library never prints", re.compile(r"\b(std::(cout|cerr|clog)|f?printf|fputs|puts|perror)\b\s*(<<|\()")),
    ("the library never exits", re.compile(r"\b(std::)?(exit|_exit|quick_exit|abort|terminate)\s*\(")),
]


def files(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            parts = path.relative_to(root).parts
            if path.is_file() and path.suffix in TEXT and "__pycache__" not in parts and "wrong_tree" not in parts:
                yield path, parts


def has_head(path, parts, lines):
    """Returns whether a file has a head comment. A .cpp file may rely on the head of its header."""
    root = path.parents[len(parts) - 1]
    headers = [path.with_suffix(".hpp"), root / "include" / "octopair" / f"{path.stem}.hpp"]
    return bool(lines) and (lines[0].startswith("// ") or (path.suffix == ".cpp" and any(h.exists() for h in headers)))


def doubled_definitions(text):
    """Yields (line number, violation) for each function or class of Python that a later one of the same name replaces."""
    for body in (node.body for node in ast.walk(ast.parse(text)) if isinstance(node, (ast.Module, ast.ClassDef))):
        seen = set()
        for node in body:
            # A decorator may use the definition before, as that of a property's setter does.
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.decorator_list:
                if node.name in seen:
                    yield node.lineno, f"'{node.name}' is defined twice; the second definition hides the first"
                seen.add(node.name)


def complaints_of(path, parts):
    """Yields (line number, violation) for a file; line 0 means the whole file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    is_code = path.suffix in CODE
    if is_code:
        if len(lines) > LONGEST_FILE:
            yield 0, f"{len(lines)} lines; at most {LONGEST_FILE}"
        if not SNAKE_CASE.match(path.stem.removesuffix("-inl")):
            yield 0, "file names are snake_case"
        if not has_head(path, parts, lines):
            yield 0, "the file has no head comment"
        if path.suffix == ".hpp" and "#pragma once" not in lines and not path.name.endswith("-inl.hpp"):
            yield 0, "no #pragma once"
    if path.suffix == ".py":
        yield from doubled_definitions("\n".join(lines))
    rules = list(EVERYWHERE) if path.name != "source_rules.py" else []
    if is_code:
        rules += IN_CODE
        is_program = parts[1] == "cli" or path.stem.endswith("_main")
        if parts[0] == "include" or (parts[0] == "src" and not is_program):
            rules += IN_LIBRARY
    for number, line in enumerate(lines, 1):
        for what, pattern in rules:
            if pattern.search(line):
                yield number, f"{what}: {line.strip()[:80]}"


def absent_failures(root):
    """Yields the lines of tests/unreached_failures.txt that name code which no source has."""
    listed = root / "tests" / "unreached_failures.txt"
    lines = listed.read_text().splitlines() if listed.exists() else []
    for number, line in enumerate(lines, 1):
        if not line or line.startswith("#"):
            continue
        name, _, code = line.partition(": ")
        source = root / name
        if not source.is_file() or code not in map(str.strip, source.read_text().splitlines()):
            yield listed, number, f"{name} has no such line"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    count = wrong = 0
    for path, parts in files(root):
        count += 1
        for line, what in complaints_of(path, parts):
            wrong += 1
            print(f"{path.relative_to(root)}:{line}: {what}")
    for path, line, what in absent_failures(root):
        wrong += 1
        print(f"{path.relative_to(root)}:{line}: {what}")
    if not wrong:
        print(f"{count} files follow the rules")
    return 1 if wrong or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())

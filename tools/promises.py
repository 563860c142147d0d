#!/usr/bin/env python3
"""Checks docs/promises.md: the tests and the pages that it names exist, and every promise has a test.

    promises.py [ROOT]     ROOT: the project's directory; default: the parent of tools/

A table with the header `promise | said in | held by` has one promise in a row. Its last cell names tests as code:

    `Suite.Name`             GoogleTest or rapidcheck: TEST, TEST_F, TEST_P, TYPED_TEST or RC_GTEST_PROP of tests/**/*.cpp
    `name`                   ctest: add_test in a CMakeLists.txt of tests/, whose loops and functions are followed
    `file.py::name`          Python: a function or method, also `file.py::Class.name`
    `file.mjs::title`        JavaScript: test('title', ...)

A table with the header `promise | said in | reason` has the promises without a test; they need a reason.
Prints one line for each fault, and exits 1.
"""
import ast
import collections
import pathlib
import re
import sys

PAGE = "docs/promises.md"
HEADERS = (["promise", "said in", "held by"], ["promise", "said in", "reason"])
CASE = re.compile(r"^(TEST|TEST_F|TEST_P|TYPED_TEST|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+)", re.M)
# A suite with parameters runs only if this macro names it.
STARTED_BY = {"TEST_P": "INSTANTIATE_TEST_SUITE_P", "TYPED_TEST": "TYPED_TEST_SUITE"}
TITLE = re.compile(r"^ *test\((['\"`])(.*?)\1", re.M)
COMMAND = re.compile(r"(\w+)\s*\(((?:[^()\"]|\"(?:\\.|[^\"\\])*\"|\([^()]*\))*)\)")
WORD = re.compile(r'"(?:\\.|[^"\\])*"|[^\s"]+')
VARIABLE = re.compile(r"\$\{(\w+)\}")


def gtest_names(root):
    """Returns the names Suite.Name of the C++ tests that a CMakeLists.txt compiles."""
    built = "\n".join(path.read_text(encoding="utf-8") for path in root.glob("tests/**/CMakeLists.txt"))
    names = set()
    for path in root.glob("tests/**/*.cpp"):
        text = path.read_text(encoding="utf-8")
        for kind, suite, name in CASE.findall(text) if re.search(rf"\b{path.name}\b", built) else ():
            macro = STARTED_BY.get(kind)
            # The first argument of INSTANTIATE_TEST_SUITE_P is a prefix, and the second one is the suite.
            if macro is None or re.search(rf"{macro}\(\s*(\w*,\s*)?{suite}\b", text):
                names.add(f"{suite}.{name}")
    return names


def python_names(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            yield node.name
        if isinstance(node, ast.ClassDef):
            yield from (f"{node.name}.{inner.name}" for inner in node.body if isinstance(inner, ast.FunctionDef))


def script_names(root):
    """Returns the names file::test of tests in Python and JavaScript."""
    names = {f"{path.name}::{name}" for path in root.glob("tests/**/*.py") for name in python_names(path) if name.startswith("test_")
             or ".test_" in name}
    return names | {f"{path.name}::{title}" for path in root.glob("tests/**/*.mjs")
                    for _, title in TITLE.findall(path.read_text(encoding="utf-8"))}


class Lists:
    """Finds the names of tests that a CMakeLists.txt adds. A variable has all values that the file gives it, whatever the conditions."""

    def __init__(self, root, path):
        self.root, self.names = root, set()
        self.values, self.functions = collections.defaultdict(list), {}
        text = re.sub(r"#.*", "", path.read_text(encoding="utf-8"))
        self.run([(command.lower(), [word.strip('"') for word in WORD.findall(words)]) for command, words in COMMAND.findall(text)], {})

    def expanded(self, word, known):
        """Returns the values of a word. Variables that the file does not set stay as they are."""
        for name in VARIABLE.findall(word):
            values = known.get(name) or self.values.get(name)
            if values:
                return [done for value in values for done in self.expanded(word.replace(f"${{{name}}}", value), known)]
        return [word]

    def run(self, commands, known):
        at = 0
        while at < len(commands):
            command, words = commands[at]
            at += 1
            if command in ("foreach", "function"):
                end = at + self.length_of(commands[at:], command)
                body, at = commands[at:end], end + 1
                if command == "function":
                    self.functions[words[0].lower()] = (words[1:], body)
                else:
                    for value in self.loop_values(words[1:], known):
                        self.run(body, {**known, words[0]: [value]})
            elif command in self.functions:
                parameters, body = self.functions[command]
                values = [value for word in words for value in self.expanded(word, known)]
                inner = {name: [value] for name, value in zip(parameters, values)}
                self.run(body, {**inner, "ARGN": values[len(parameters):]})
            elif command == "add_test" and words[:1] == ["NAME"]:
                self.names.update(self.expanded(words[1], known))
            elif command == "octopair_browser_test":
                self.names.update(self.expanded(words[0], known))
            elif command in ("set", "list", "file", "get_filename_component"):
                self.assign(command, words, known)

    @staticmethod
    def length_of(commands, kind):
        """Returns the number of commands before the end of a block."""
        depth = 1
        for number, (command, _) in enumerate(commands):
            depth += (command == kind) - (command == f"end{kind}")
            if depth == 0:
                return number
        return len(commands)

    def loop_values(self, words, known):
        if words[:2] == ["IN", "LISTS"]:
            words = [f"${{{word}}}" for word in words[2:]]
        elif words[:2] == ["IN", "ITEMS"]:
            words = words[2:]
        return [value for word in words for value in self.expanded(word, known)]

    def assign(self, command, words, known):
        if command == "file" and words[0] == "GLOB":
            folder, pattern = (re.sub(r"^\$\{PROJECT_SOURCE_DIR\}/", "", word) for word in (words[-2], words[-1]))
            self.values[words[1]] += [str(path.relative_to(self.root / folder)) for path in sorted(self.root.glob(pattern))]
        elif command == "get_filename_component" and words[2] == "NAME_WE":
            known[words[0]] = [pathlib.PurePath(value).name.partition(".")[0] for value in self.expanded(words[1], known)]
        elif command in ("set", "list"):
            name, given = (words[1], words[2:]) if command == "list" else (words[0], words[1:])
            if command == "set" or words[0] == "APPEND":
                self.values[name] += [value for word in given for value in self.expanded(word, known) if f"${{{name}}}" not in value]


def ctest_names(root):
    """Returns the names of ctest's tests. Two functions of tests/CMakeLists.txt add tests for other folders."""
    names = set()
    for path in root.glob("tests/**/CMakeLists.txt"):
        text = re.sub(r"#.*", "", path.read_text(encoding="utf-8"))
        names |= Lists(root, path).names
        for program, *more in map(str.split, re.findall(r"octopair_instruction_sets\((\w[\w ]*)\)", text)):
            names |= {f"{program}.{instructions}" for instructions in ("AVX2", "SSE4", *more)}
    return {name for name in names if "$" not in name}


def rows_of(lines):
    """Yields (line number, kind, cells) for each row of a table: kind is its header."""
    kind = None
    for number, line in enumerate(lines, 1):
        if not line.startswith("|"):
            kind = None
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if kind is None:
            kind = cells
        elif not re.fullmatch(r"[|: -]+", line):
            yield number, kind, cells


def faults_of_row(root, kind, cells, tests):
    if kind not in HEADERS:
        yield f"a table has the columns {' | '.join(kind)}, not {' or '.join(' | '.join(header) for header in HEADERS)}"
        return
    if len(cells) != 3 or not cells[0]:
        yield "a row needs a promise, pages and tests"
        return
    pages = re.findall(r"\]\(([^)#\s]+)", cells[1])
    if not pages:
        yield "no page says the promise"
    yield from (f"no page {page}" for page in pages if not (root / PAGE).parent.joinpath(page).is_file())
    if kind == HEADERS[1]:
        if len(cells[2].split()) < 3:
            yield "a promise without a test needs a reason"
        return
    named = re.findall(r"`([^`]+)`", cells[2])
    if not named:
        yield "the promise has no test"
    yield from (f"no test {name}" for name in named if name not in tests)


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[1]).resolve()
    tests = gtest_names(root) | script_names(root) | ctest_names(root)
    faults, seen, held = [], {}, 0
    for number, kind, cells in rows_of((root / PAGE).read_text(encoding="utf-8").splitlines()):
        complaints = list(faults_of_row(root, kind, cells, tests))
        if cells[0] in seen:
            complaints.append(f"line {seen[cells[0]]} has the same promise")
        seen[cells[0]] = number
        held += kind == HEADERS[0]
        faults += [f"{PAGE}:{number}: {complaint}" for complaint in complaints]
    if not held:
        faults.append(f"{PAGE}: no promise is held by a test")
    print("\n".join(faults) or f"{held} promises have tests, {len(seen) - held} have none")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Runs the fenced blocks of a Markdown page in order, in a fresh folder, and compares their output with the page.

    run_page.py PAGE [--python PROGRAM] [--keep FOLDER] [--update]

--update writes outputs that differ into the page. Without it, they are errors.

A block of the page is one of these:

    ```sh                   Runs in bash. All such blocks of a page share one shell, which stops at the first error.
    ```python               Runs in one interpreter for all such blocks of a page.
    ```LANGUAGE file=NAME   Is written to the file NAME. A later block must use this name.
    ```text                 The output of the block before, which is a sh or python block. Without it, only the exit status counts.
    ```text bytes=NAME      The bytes of the file NAME, line by line (file_bytes.py).

In an output, durations such as `12.3 ms` may differ. The comment `<!-- varies: PATTERN -->` before the block lets all parts that
match a regular expression differ, as long as both outputs have such a part there. A line `...` stands for any lines.

Each error names the page and the line. The exit status is 1 after an error.
"""
import argparse
import difflib
import os
import pathlib
import re
import shutil
import sys
import tempfile

import file_bytes
import sessions

FENCE = re.compile(r"^```(\w*) *(.*)$")
VARIES = re.compile(r"^<!-- varies: (.*) -->$")
DURATION = r"\d+(?:\.\d+)?(?:e-\d+)? (?:us|ms|s)\b"
BLOCK_SECONDS = 120


class PageError(Exception):
    pass


class Block:
    def __init__(self, line, language, options, varies):
        self.line, self.language, self.varies = line, language, varies
        self.options = dict(option.partition("=")[::2] for option in options.split())
        self.lines = []

    def text(self):
        return "".join(line + "\n" for line in self.lines)


def blocks_of(page):
    """Returns the blocks of a page. Indented code is prose."""
    found, block, varies = [], None, DURATION
    for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
        fence = FENCE.match(line)
        comment = VARIES.match(line)
        if block is not None and line == "```":
            block = None
        elif block is not None:
            block.lines.append(line)
        elif fence:
            block = Block(number, fence[1], fence[2], varies)
            found.append(block)
            varies = DURATION
        elif comment:
            varies = f"{DURATION}|{comment[1]}"
    if block is not None:
        raise PageError(f"{block.line}: the block has no end")
    return found


def matches(shown, printed):
    """Returns whether the printed lines agree with the shown lines, where a line `...` stands for any lines."""
    if "..." not in shown:
        return shown == printed
    at = shown.index("...")
    if shown[:at] != printed[:at]:
        return False
    rest = shown[at + 1:]
    return any(matches(rest, printed[begin:]) for begin in range(at, len(printed) + 1))


def agrees(block, printed):
    def lines(text):
        return [re.sub(block.varies, "~", line.rstrip()) for line in text.rstrip("\n").split("\n")]
    return matches(lines(block.text()), lines(printed))


def compare(block, printed):
    if agrees(block, printed):
        return
    shown = [line.rstrip() for line in block.lines]
    difference = difflib.unified_diff(shown, printed.rstrip("\n").split("\n"), "the page", "the output", lineterm="", n=100)
    raise PageError(f"{block.line}: the output differs:\n" + "\n".join(difference))


def update(page, blocks):
    """Writes the new outputs of blocks into a page."""
    lines = page.read_text(encoding="utf-8").split("\n")
    for block in sorted(blocks, key=lambda block: -block.line):
        lines[block.line:block.line + len(block.lines)] = block.update
    page.write_text("\n".join(lines), encoding="utf-8")


class Runner:
    def __init__(self, folder, python, updates):
        self.folder, self.printed, self.updates = folder, None, updates
        self.shell = sessions.Shell(folder)
        self.python = sessions.Python(folder, python)

    def run(self, block):
        name = block.options.get("file") or block.options.get("bytes")
        if "file" in block.options:
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / name).write_text(block.text(), encoding="utf-8")
        elif "bytes" in block.options:
            try:
                file_bytes.check(block.lines, (self.folder / name).read_bytes())
            except (file_bytes.Difference, OSError) as error:
                raise PageError(f"{block.line + getattr(error, 'line', 0)}: {name}: {error}") from None
        elif block.language in ("sh", "python"):
            session = self.shell if block.language == "sh" else self.python
            # Empty lines in front make the session's messages name the lines of the page.
            well, self.printed = session.run("\n" * block.line + block.text(), BLOCK_SECONDS)
            if not well:
                raise PageError(f"{block.line}: the block failed:\n{self.printed}")
        elif block.language == "text" and self.printed is not None:
            if self.updates is None:
                compare(block, self.printed)
            elif not agrees(block, self.printed):
                block.update = [line.rstrip() for line in self.printed.rstrip("\n").split("\n")]
                self.updates.append(block)
            self.printed = None
        else:
            raise PageError(f"{block.line}: the test does not run a block '{block.language}' here; see run_page.py")

    def end(self):
        self.shell.end()
        self.python.end()


def check_use(blocks):
    for at, block in enumerate(blocks):
        name = block.options.get("file", "").replace("CMakeLists.txt", "cmake")
        if name and not any(name in later.text() for later in blocks[at + 1:]):
            raise PageError(f"{block.line}: no later block uses the file {name}")


def run_page(page, folder, python, updates=None):
    blocks = blocks_of(page)
    if not any(block.language in ("sh", "python") for block in blocks):
        raise PageError("1: the page has no blocks to run")
    check_use(blocks)
    runner = Runner(folder, python, updates)
    try:
        for block in blocks:
            runner.run(block)
    finally:
        runner.end()
    return len(blocks)


def main():
    parser = argparse.ArgumentParser(usage="run_page.py PAGE [--python PROGRAM] [--keep FOLDER] [--update]")
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--keep", type=pathlib.Path, help="an empty folder for the files, which stay")
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args()
    tools = pathlib.Path(tempfile.mkdtemp(prefix="octopair-docs-"))
    folder = options.keep or tools / "page"
    folder.mkdir(parents=True, exist_ok=True)
    # The pages call python3. Modules of the system belong to this one.
    (tools / "bin").mkdir()
    (tools / "bin/python3").symlink_to(options.python)
    os.environ["PATH"] = f"{tools / 'bin'}:{os.environ['PATH']}"
    try:
        updates = [] if options.update else None
        count = run_page(options.page, folder.resolve(), options.python, updates)
        if updates:
            update(options.page, updates)
        print(f"{options.page.name}: {count} blocks ran as the page shows")
        return 0
    except PageError as error:
        print(f"{options.page}:{error}")
        return 1
    finally:
        shutil.rmtree(tools)


if __name__ == "__main__":
    sys.exit(main())

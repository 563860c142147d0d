#!/usr/bin/env python3
"""Checks that the manual page describes every option of the program.

    manual_test.py PROGRAM PAGE     PAGE: docs/octopair.1

The page may describe more: options of parts that a build lacks.
"""
import pathlib
import re
import subprocess
import sys

OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*[a-z]")


def help_of(program, *subcommand):
    return subprocess.run([program, *subcommand, "--help"], capture_output=True, text=True, check=True).stdout


def options_of(text):
    """Returns the options that a help defines: each line of an option begins with two spaces and a dash."""
    return {option for line in text.splitlines() if re.match(r"  -", line) for option in OPTION.findall(line.split("   ")[0])}


def main():
    program, page = sys.argv[1:]
    manual = set(OPTION.findall(pathlib.Path(page).read_text(encoding="utf-8").replace("\\-", "-")))
    overview = help_of(program)
    subcommands = re.findall(r"^  ([a-z]+)  ", overview.partition("Subcommands:")[2], re.M)
    assert {"detect", "generate", "info"} <= set(subcommands), overview
    options = options_of(overview).union(*(options_of(help_of(program, name)) for name in subcommands))
    assert len(options) > 20, options
    missing = sorted(options - manual)
    for option in missing:
        print(f"{page}: {option} is missing")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Runs clang-tidy (.clang-tidy) on the library and the program, several sources at once where they are compiled so.

    tidy.py CLANG_TIDY ROOT BUILD
"""
import pathlib
import subprocess
import sys

from sources import Check, all_pass, compiled


def main(words):
    if len(words) != 3:
        sys.exit("tidy.py CLANG_TIDY ROOT BUILD")
    program, root, build = words[0], *(pathlib.Path(word).resolve() for word in words[1:])
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
    tidy = Check("tidy", root, build, version + (root / ".clang-tidy").read_text(encoding="utf-8"))
    commands = compiled(root, build)
    jobs = [(file, command, [program, "--quiet", "-p", str(build), str(file)]) for file, command in sorted(commands.items())]
    passed = all_pass(tidy.passes, jobs)
    print(f"{passed} of {len(jobs)} compiled files are tidy")
    return 0 if passed == len(jobs) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

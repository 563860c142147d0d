#!/usr/bin/env python3
"""Compiles each source and header of the library and the program alone: it includes what it needs, whatever was compiled
before it in the same file.

    sources_alone.py ROOT BUILD

A header that its source includes first is alone there.
"""
import pathlib
import shlex
import sys

from sources import Check, all_pass, compiled, included, sources_in


def flags_of(command):
    """A compiler and what it is told, without the file that it compiles."""
    words = shlex.split(command)
    if words[0].endswith("ccache"):
        words = words[1:]
    leave_out = {"-c": 2, "-o": 2, "-MD": 1, "-MT": 2, "-MF": 2}
    flags = []
    while words:
        skip = leave_out.get(words[0], 0)
        if not skip:
            flags.append(words.pop(0))
        words = words[skip:]
    return flags


def first_included(source):
    return next(iter(included(source)), "")


def flags_of_sources(root, build):
    return {source: flags_of(command) for file, command in compiled(root, build).items()
            for source in sources_in(file, root)}


def headers_alone(root):
    """Headers that no source of their name includes first."""
    for header in sorted([*(root / "include").rglob("*.hpp"), *(root / "src").rglob("*.hpp")]):
        # A kernel that Highway includes once for each instruction set is no header of its own.
        if "#pragma once" not in header.read_text(encoding="utf-8"):
            continue
        source = header.with_suffix(".cpp")
        if not source.is_file() or not str(header).endswith("/" + first_included(source)):
            yield header


def main(words):
    if len(words) != 2:
        sys.exit("sources_alone.py ROOT BUILD")
    root, build = (pathlib.Path(word).resolve() for word in words)
    flags = flags_of_sources(root, build)
    for header in list(headers_alone(root)):
        name = header.relative_to(root).as_posix().split("/", 1)[1]
        users = [source for source in sorted(flags) if source.suffix == ".cpp" and name in included(source)]
        users += [source for source in sorted(flags) if source.parent == header.parent]
        flags[header] = flags[users[0] if users else sorted(flags)[0]]
    check = Check("alone", root, build, "")
    jobs = [(file, " ".join(told), [*told, "-fsyntax-only", "-Wno-pragma-once-outside-header", "-x", "c++", str(file)])
            for file, told in sorted(flags.items())]
    passed = all_pass(check.passes, jobs)
    print(f"{passed} of {len(jobs)} sources and headers compile alone")
    return 0 if passed == len(jobs) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""Compiles each source and header of the library and the program alone. So each file must include all that it needs.

    sources_alone.py ROOT BUILD

In the build, a unity file can hide a missing #include, because sources before this source may include the header. A
header that its source includes first is checked with this source.

Headers that many files include are precompiled, which saves 40% of the time. A file gets a precompiled header only if
the file includes this header, directly or not. So the only difference is that this header comes first. This hides no
missing #include: the files that now come after the header are compiled alone as well.
"""
import pathlib
import subprocess
import sys
import threading

from sources import Check, all_pass, compiled, flags_of, included, sources_in


def first_included(source):
    return next(iter(included(source)), "")


def flags_of_sources(root, build):
    return {source: flags_of(command) for file, command in compiled(root, build).items()
            for source in sources_in(file, root)}


def headers_alone(root):
    """Yields the headers that no source of the same name includes first."""
    for header in sorted([*(root / "include").rglob("*.hpp"), *(root / "src").rglob("*.hpp")]):
        # Kernels do not compile alone: Highway includes them once for each instruction set.
        if "#pragma once" not in header.read_text(encoding="utf-8"):
            continue
        source = header.with_suffix(".cpp")
        if not source.is_file() or not str(header).endswith("/" + first_included(source)):
            yield header


class Precompiled:
    """Precompiles headers at their first use, once for each set of compiler options.

    Thread safety: all functions may be called at any time."""

    # Sorted by compile time, longest first: a file gets the first header that the file includes.
    HEADERS = ("nlohmann/json.hpp", "octopair/pipeline.hpp", "octopair/engine.hpp", "octopair/objects.hpp")

    def __init__(self, check):
        self.check = check
        self.folder = check.build / "alone"
        self.folder.mkdir(exist_ok=True)
        self.made = {}
        self.lock = threading.Lock()

    def options_for(self, file, flags):
        """Returns the compiler options with which a file uses a precompiled header, or none without such a header."""
        names = {name for part in self.check.closure(file) for name in included(part)}
        for header in self.HEADERS:
            if header in names:
                return ["-include-pch", str(self.make(header, flags))]
        return []

    def make(self, header, flags):
        """Returns the precompiled header for these flags."""
        # Macros may differ between a file and its precompiled header: these headers use no macros of the project.
        flags = [flag for flag in flags if not flag.startswith("-D")]
        # Include folders may differ, too: no header is in two folders.
        key = (header, *(flag for flag in flags if not flag.startswith(("-I", "-isystem", "/"))))
        with self.lock:
            if key not in self.made:
                source = self.folder / f"{len(self.made)}.hpp"
                source.write_text(f"#include <{header}>\n", encoding="utf-8")
                self.made[key] = source.with_suffix(".pch")
                subprocess.run([*flags, "-x", "c++-header", str(source), "-o", str(self.made[key])], check=True)
            return self.made[key]


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
    precompiled = Precompiled(check)
    options = ["-fsyntax-only", "-Wno-pragma-once-outside-header", "-x", "c++"]
    jobs = [(file, " ".join(told), lambda file=file, told=told:
             [*told, *options, *precompiled.options_for(file, told), str(file)])
            for file, told in sorted(flags.items())]
    passed = all_pass(check.passes, jobs)
    print(f"{passed} of {len(jobs)} sources and headers compile alone")
    return 0 if passed == len(jobs) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

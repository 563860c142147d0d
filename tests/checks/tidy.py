#!/usr/bin/env python3
"""Runs clang-tidy (.clang-tidy) on the library and the program.

    tidy.py CLANG_TIDY ROOT BUILD

Headers of libraries take most of the time. So all unity files of a target are checked as one file.
"""
import pathlib
import subprocess
import sys

from sources import Check, all_pass, compiled, flags_of


def grouped_by_target(root, build):
    """Yields the files to check, each with its command. If a target has several unity files, one file includes all."""
    groups = {}
    for file, command in sorted(compiled(root, build).items()):
        target = "" if file.is_relative_to(root / "src") else file.parent.parent.stem
        groups.setdefault(target or file, []).append((file, command))
    folder = build / "tidy"
    folder.mkdir(exist_ok=True)
    for target, members in groups.items():
        file, command = members[0]
        if len(members) > 1:
            file = folder / f"{target}.cpp"
            file.write_text("".join(f'#include "{member}"\n' for member, _ in members), encoding="utf-8")
        yield file, command


def main(words):
    if len(words) != 3:
        sys.exit("tidy.py CLANG_TIDY ROOT BUILD")
    program, root, build = words[0], *(pathlib.Path(word).resolve() for word in words[1:])
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
    tidy = Check("tidy", root, build, version + (root / ".clang-tidy").read_text(encoding="utf-8"))
    # A name of one source may shadow a name of another source, because only this check compiles them together.
    options = ["--quiet", f"--config-file={root}/.clang-tidy"]
    jobs = [(file, command, lambda file=file, command=command:
             [program, *options, str(file), "--", *flags_of(command), "-Wno-shadow"])
            for file, command in grouped_by_target(root, build)]
    passed = all_pass(tidy.passes, jobs)
    print(f"{passed} of {len(jobs)} files are tidy; all unity files of a target count as one")
    return 0 if passed == len(jobs) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

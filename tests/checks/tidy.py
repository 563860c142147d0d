#!/usr/bin/env python3
"""Runs clang-tidy (.clang-tidy) on the library and the program.

    tidy.py CLANG_TIDY ROOT BUILD

BUILD holds compile_commands.json. A file that passed is not looked at again until it, a header of the project that it
includes, directly or not, its compiler's command or the rules change. What passed is noted in the cache of the user, so
that holds for all checkouts.
"""
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

NOISE = re.compile(r"^(\d+ warnings? (generated|treated)|Suppressed|$)")


class Tidy:
    def __init__(self, program, root, build):
        self.program, self.root, self.build = program, root, build
        cache = os.environ.get("XDG_CACHE_HOME") or pathlib.Path(os.environ.get("HOME") or build) / ".cache"
        self.passed = pathlib.Path(cache) / "octopair" / "tidy"
        self.passed.mkdir(parents=True, exist_ok=True)
        version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
        self.rules = version + (root / ".clang-tidy").read_text(encoding="utf-8")

    @functools.lru_cache(maxsize=None)
    def includes(self, path):
        """The project's files that a file names; of a generated one, what it is generated from."""
        found = []
        for name in re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', path.read_text(encoding="utf-8"), re.MULTILINE):
            source = re.sub(r"(\.grpc)?\.pb\.h$", ".proto", name)
            places = (self.root / folder / source for folder in ("include", "src"))
            found += [place for place in [*places, path.parent / source] if place.is_file()]
        return found

    def digest(self, path, command):
        """Of all that the outcome depends on."""
        seen, to_see = set(), [path]
        while to_see:
            file = to_see.pop()
            if file not in seen:
                seen.add(file)
                to_see += self.includes(file)
        whole = hashlib.sha256((self.rules + command.replace(str(self.root), "")).encode())
        for file in sorted(seen):
            whole.update(str(file.relative_to(self.root)).encode() + b"\0" + file.read_bytes())
        return whole.hexdigest()[:32]

    def passes(self, path, command):
        mark = self.passed / self.digest(path, command)
        if mark.exists():
            return True
        run = subprocess.run([self.program, "--quiet", "-p", str(self.build), str(path)], capture_output=True, text=True,
                             check=False)
        words = [line for line in run.stderr.splitlines() if not NOISE.match(line)]
        sys.stdout.write(run.stdout + "".join(line + "\n" for line in words))
        sys.stdout.flush()
        if run.returncode == 0:
            mark.touch()
        return run.returncode == 0


def main(words):
    if len(words) != 3:
        sys.exit("tidy.py CLANG_TIDY ROOT BUILD")
    root, build = (pathlib.Path(word).resolve() for word in words[1:])
    tidy = Tidy(words[0], root, build)
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    commands = {pathlib.Path(entry["file"]): entry["command"] for entry in entries}
    files = sorted(file for file in commands if file.is_relative_to(root / "src"))
    if not files:
        sys.exit(f"no file of src/ in {build}/compile_commands.json")
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        passed = list(pool.map(lambda file: tidy.passes(file, commands[file]), files))
    print(f"{sum(passed)} of {len(files)} files are tidy")
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Helpers for checks of the source: the compile command of each file, and a cache of the files that passed a check.

CMake compiles several sources as one unity file (CMAKE_UNITY_BUILD), which includes them by their absolute paths.
"""
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def compiled(root, build):
    """Returns the compile command of each source and each unity file of the library and the program."""
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    commands = {pathlib.Path(entry["file"]): entry["command"] for entry in entries}
    found = {file: command for file, command in commands.items()
             if file.is_relative_to(root / "src") or (file.is_relative_to(build / "src") and "/Unity/" in str(file))}
    if not found:
        sys.exit(f"no file of src/ in {build}/compile_commands.json")
    return found


def flags_of(command):
    """Returns the compiler and its options, without the file to compile and the outputs.

    Highway includes a kernel once for each instruction set of its list. One of them is enough to check the source."""
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
    return [*flags, "-DHWY_COMPILE_ONLY_STATIC"]


def included(file):
    """Returns the names in a file's #include lines."""
    return INCLUDE.findall(file.read_text(encoding="utf-8"))


def sources_in(file, root):
    """Returns a source itself, or the sources of a unity file."""
    if file.is_relative_to(root / "src"):
        return [file]
    return [pathlib.Path(name) for name in included(file) if name.endswith(".cpp")]


class Check:
    """A check that each file passes or fails.

    A file that passed is checked again only after a change of the file, of a project file that it includes (directly
    or not), of its compile command, or of the rules. The user's cache holds the passes, so all checkouts share them."""

    def __init__(self, name, root, build, rules):
        self.root, self.build, self.rules = root, build, rules
        cache = os.environ.get("XDG_CACHE_HOME") or pathlib.Path(os.environ.get("HOME") or build) / ".cache"
        self.passed = pathlib.Path(cache) / "octopair" / name
        self.passed.mkdir(parents=True, exist_ok=True)

    @functools.lru_cache(maxsize=None)
    def includes(self, path):
        """Returns the project's files that a file includes; for a generated header, its .proto file."""
        found = []
        for name in included(path):
            source = re.sub(r"(\.grpc)?\.pb\.h$", ".proto", name)
            places = (self.root / folder / source for folder in ("include", "src"))
            found += [place for place in [*places, path.parent / source] if place.is_file()]
        return found

    @functools.lru_cache(maxsize=None)
    def closure(self, path):
        """Returns a file and the project's files that it includes, directly or not."""
        seen, to_see = set(), [path]
        while to_see:
            file = to_see.pop()
            if file not in seen:
                seen.add(file)
                to_see += self.includes(file)
        return seen

    def digest(self, path, command):
        """Returns a hash of everything that the outcome depends on: rules, command, and the contents of all files."""
        seen = self.closure(path)
        whole = hashlib.sha256((self.rules + command.replace(str(self.root), "")).encode())
        for file in sorted(seen):
            content = file.read_bytes().replace(str(self.root).encode(), b"")
            whole.update(os.path.relpath(file, self.root).encode() + b"\0" + content)
        return whole.hexdigest()[:32]

    def passes(self, path, command, arguments):
        """Returns whether the file passes: it has passed before, or the command that `arguments()` returns succeeds.

        Prints the output of a command that fails."""
        mark = self.passed / self.digest(path, command)
        if mark.exists():
            return True
        run = subprocess.run(arguments(), cwd=self.build, capture_output=True, text=True, check=False)
        if run.returncode == 0:
            mark.touch()
        else:
            sys.stdout.write(f"{path}:\n{run.stdout}{run.stderr}")
            sys.stdout.flush()
        return run.returncode == 0


def all_pass(passes, jobs):
    """Calls passes(*job) for all jobs, several at a time. Returns how many passed."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return sum(pool.map(lambda job: passes(*job), jobs))

"""What the build compiles, for checks of the source: commands by file, and which files passed a check before.

Several sources are compiled in one (CMAKE_UNITY_BUILD): a file that CMake wrote includes them by their absolute paths.
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
    """Of each file that is compiled for the library and the program, or that CMake wrote to compile several: its command."""
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    commands = {pathlib.Path(entry["file"]): entry["command"] for entry in entries}
    found = {file: command for file, command in commands.items()
             if file.is_relative_to(root / "src") or (file.is_relative_to(build / "src") and "/Unity/" in str(file))}
    if not found:
        sys.exit(f"no file of src/ in {build}/compile_commands.json")
    return found


def flags_of(command):
    """Returns the compiler and its options, without the file to compile and the outputs."""
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


def included(file):
    """The names in a file's #include lines."""
    return INCLUDE.findall(file.read_text(encoding="utf-8"))


def sources_in(file, root):
    """A file itself, or the sources that CMake compiles through it."""
    if file.is_relative_to(root / "src"):
        return [file]
    return [pathlib.Path(name) for name in included(file) if name.endswith(".cpp")]


class Check:
    """One that a file passes or not. A file that passed is not looked at again until it, a file of the project that it
    includes, directly or not, its compiler's command or the rules change. What passed is noted in the cache of the user,
    so that it holds for all checkouts."""

    def __init__(self, name, root, build, rules):
        self.root, self.build, self.rules = root, build, rules
        cache = os.environ.get("XDG_CACHE_HOME") or pathlib.Path(os.environ.get("HOME") or build) / ".cache"
        self.passed = pathlib.Path(cache) / "octopair" / name
        self.passed.mkdir(parents=True, exist_ok=True)

    @functools.lru_cache(maxsize=None)
    def includes(self, path):
        """The project's files that a file names; of a generated one, what it is generated from."""
        found = []
        for name in included(path):
            source = re.sub(r"(\.grpc)?\.pb\.h$", ".proto", name)
            places = (self.root / folder / source for folder in ("include", "src"))
            found += [place for place in [*places, path.parent / source] if place.is_file()]
        return found

    @functools.lru_cache(maxsize=None)
    def closure(self, path):
        """A file and the project's files that it includes, directly or not."""
        seen, to_see = set(), [path]
        while to_see:
            file = to_see.pop()
            if file not in seen:
                seen.add(file)
                to_see += self.includes(file)
        return seen

    def digest(self, path, command):
        """Of all that the outcome depends on."""
        seen = self.closure(path)
        whole = hashlib.sha256((self.rules + command.replace(str(self.root), "")).encode())
        for file in sorted(seen):
            content = file.read_bytes().replace(str(self.root).encode(), b"")
            whole.update(os.path.relpath(file, self.root).encode() + b"\0" + content)
        return whole.hexdigest()[:32]

    def passes(self, path, command, arguments):
        """Whether a program, run with the words that `arguments()` returns, ends well; prints what it says."""
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
    """Calls passes(*job) for all jobs, several at a time; how many passed."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return sum(pool.map(lambda job: passes(*job), jobs))

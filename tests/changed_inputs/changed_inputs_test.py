#!/usr/bin/env python3
"""Truncates, grows, overwrites and replaces inputs of `octopair` at random moments of a run.

    changed_inputs_test.py --program PATH --library PATH [--view]

The result is the answer to the old content, the answer to the new content, or an error that says that the file changed. The program never
crashes, and leaves no result file after an error. The library (change_at_call.cpp) changes the file before a random one of the system calls
that the program makes on it, so the moments are those that matter, and the test needs no clock.

OCTOPAIR_TEST_SHARE sets the number of runs in per cent of the usual number, and OCTOPAIR_TEST_CASES the number itself.
OCTOPAIR_TEST_SEED=N makes only run N, and shows it.
"""
import argparse
import base64
import collections
import gzip
import json
import os
import random
import re
import struct
import subprocess
import sys
import tempfile

from formats import FORMATS, VIEWED

USUAL_RUNS = 60
LONG_AGO = 1_500_000_000  # time of all inputs: before the change by more than any step of a file system's times
COMMANDS = {"detect": ("--quiet", "--threads", "1"), "view": ("--quiet",)}
RESULTS = ("page.html",)


def without_times(value):
    """Returns a copy of a JSON value without the times of searches."""
    if isinstance(value, dict):
        return {name: without_times(part) for name, part in value.items() if name != "seconds"}
    return [without_times(part) for part in value] if isinstance(value, list) else value


def data_of(page):
    """Returns the data of an exported page, by their addresses, without times."""
    data = {}
    for address, text in re.findall(rb'data-address="([^"]*)">([^<]*)<', page or b""):
        part = gzip.decompress(base64.b64decode(text))
        data[address] = json.dumps(without_times(json.loads(part))) if address.endswith(b".json") else part
    return data


class Folder:
    """A folder with the inputs of one command, and the program that runs there."""

    def __init__(self, arguments, made):
        self.program, self.library, self.path = os.path.abspath(arguments.program), os.path.abspath(arguments.library), made

    def file(self, name):
        return os.path.join(self.path, name)

    def write(self, name, content):
        with open(self.file(name), "wb") as file:
            file.write(content)
        os.utime(self.file(name), (LONG_AGO, LONG_AGO))

    def run(self, form, content, environment=None):
        """Returns what the program does with a content of the file: exit status, output, messages, and its result file."""
        for name in RESULTS:
            if os.path.exists(self.file(name)):
                os.remove(self.file(name))
        for name, other in form.others:
            self.write(name, other)
        self.write(form.name, content)
        done = subprocess.run([self.program, *form.arguments, *COMMANDS[form.arguments[0]]], cwd=self.path, capture_output=True, timeout=120,
                              check=False, env={**os.environ, **(environment or {})})
        results = [None if (page := self.read(name)) is None else data_of(page) for name in RESULTS]
        return done.returncode, done.stdout, done.stderr, results

    def read(self, name):
        try:
            with open(self.file(name), "rb") as file:
                return file.read()
        except FileNotFoundError:
            return None

    def run_changed(self, form, at, change):
        """Returns what the program does while the file changes, and the number of its calls on the file."""
        self.write("counter", bytes(8))
        preload = f"{self.library}:{os.environ['LD_PRELOAD']}" if "LD_PRELOAD" in os.environ else self.library
        environment = {"LD_PRELOAD": preload, "CHANGE_FILE": self.file(form.name), "CHANGE_COUNTER": self.file("counter"),
                       "CHANGE_AT": str(at), "CHANGE_BY": change}
        outcome = self.run(form, form.old, environment)
        return outcome, struct.unpack("<Q", self.read("counter"))[0]


def random_change(source, form, folder):
    """Returns a change in the words of change_at_call.cpp, and the content after it. Both files of the change are new."""
    size = len(form.old)
    kind = source.choice(("truncate", "grow", "overwrite", "overwrite a part", "replace"))
    if kind == "truncate":
        length = source.choice((0, 1, source.randrange(size), size - 1))
        return f"truncate {length}", form.old[:length]
    if kind == "replace":
        folder.write("change", form.new)
        return f"rename {folder.file('change')}", form.new
    if kind == "grow":
        at, content = size, form.more * source.randrange(1, 4)
    elif kind == "overwrite":
        at, content = 0, form.new
    else:
        at = source.randrange(size)
        content = form.new[at:at + source.randrange(1, 30)]
    folder.write("change", content)
    return f"write {at} {folder.file('change')}", form.old[:at] + content + form.old[at + len(content):]


class Test:
    """Runs of the program, and what was wrong."""

    def __init__(self, folder, forms):
        self.folder, self.forms = folder, forms
        self.known = {}  # answers to contents of files
        self.calls = {}  # numbers of calls on the file of a format
        self.outcomes, self.failures = collections.Counter(), 0

    def answer_to(self, form, content):
        if (form.name, content) not in self.known:
            self.known[form.name, content] = self.folder.run(form, content)
        return self.known[form.name, content]

    def calls_on(self, form):
        """Returns the number of calls that the program makes on the file. Also checks that the test can see a difference."""
        if form.name not in self.calls:
            old, new = self.answer_to(form, form.old), self.answer_to(form, form.new)
            outcome, calls = self.folder.run_changed(form, 0, "")
            right = old[0] == new[0] == 0 and old != new and outcome == old and calls > 0
            if not right:
                self.fail(form, "unchanged", f"{calls} calls, answers to both contents, and with the library: {old}\n  {new}\n  {outcome}")
            self.calls[form.name] = max(calls, 1)
        return self.calls[form.name]

    def fail(self, form, change, why):
        self.failures += 1
        print(f"{' '.join(form.arguments)}: {form.name}: {change}: {why[:2000]}")

    def verdict(self, form, outcome, content):
        """Returns the kind of an outcome, or nothing if it is wrong."""
        if outcome[0] < 0 or outcome[0] >= 128:
            return None
        if outcome == self.answer_to(form, form.old):
            return "old"
        is_refused = outcome[0] == 3 and outcome[1] == b"" and not any(outcome[3]) and outcome[2].startswith(b"octopair: ")
        says = any(words.encode() in outcome[2] for words in (f"{form.name}: the file changed while it was read",
                                                              f"{form.name}: the file was truncated while it was read",
                                                              f'error while reading referenced file "{form.name}"'))  # a glTF's buffer
        if is_refused and says:
            return "changed"
        if outcome == self.answer_to(form, content):
            return "new" if outcome[0] == 0 else "new, refused"
        return None

    def run(self, number, shown):
        source = random.Random(f"changed input {number}")
        form = self.forms[number % len(self.forms)]
        calls = self.calls_on(form)
        at = source.randint(1, calls)
        change, content = random_change(source, form, self.folder)
        outcome, _ = self.folder.run_changed(form, at, change)
        verdict = self.verdict(form, outcome, content)
        self.outcomes[verdict] += 1
        if verdict is None or shown:
            description = f"{change} before call {at} of {calls} (run {number})"
            text = f"{verdict}: status {outcome[0]}, {outcome[1][:400]!r}, {outcome[2][:400]!r}"
            if verdict is None:
                self.fail(form, description, text)
            else:
                print(description, text)


def numbers_of_runs():
    if "OCTOPAIR_TEST_SEED" in os.environ:
        return [int(os.environ["OCTOPAIR_TEST_SEED"])]
    share = int(os.environ.get("OCTOPAIR_TEST_SHARE", 100))
    return range(int(os.environ.get("OCTOPAIR_TEST_CASES", max(20, USUAL_RUNS * share // 100))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--library", required=True, help="change_at_call.cpp as a shared library")
    parser.add_argument("--view", action="store_true", help="the program has the subcommand view")
    arguments = parser.parse_args()
    numbers = numbers_of_runs()
    with tempfile.TemporaryDirectory() as made:
        test = Test(Folder(arguments, os.path.realpath(made)), FORMATS + (VIEWED if arguments.view else ()))
        for number in numbers:
            test.run(number, len(numbers) == 1)
    print(f"{len(numbers)} runs, {test.failures} failed; " + ", ".join(f"{kind}: {count}" for kind, count in sorted(test.outcomes.items(), key=str)))
    # A test that sees no refusal, or no answer to the new content, changes nothing in time.
    return 1 if test.failures or (len(numbers) > 1 and not (test.outcomes["changed"] and test.outcomes["new"])) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Reads results of ctest, JUnit files such as build/results/STAGE.xml.

    test_results.py --count FILE     prints "PASSED FAILED SKIPPED"; a missing or unreadable file counts as one failure
    test_results.py --slowest BEGIN BUILDS FILE...
                                     prints the slowest tests, and the files that took longest to compile since BEGIN
                                     (seconds since 1970) in the build folders below BUILDS
    test_results.py FILE...          prints the failed tests and the end of their output, for the end of a long log;
                                     files that are missing or unreadable are skipped
"""
import collections
import heapq
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

LAST_LINES = 40  # printed lines of the output of a failed test
SLOWEST = 10


def outcome(case):
    """Returns the outcome of a test. ctest reports a test without a built program as skipped; here it counts as failed."""
    if case.get("status") == "run":
        return "passed"
    skipped = case.find("skipped")
    missing = skipped is not None and skipped.get("message", "").startswith("Unable to find")
    return "failed" if missing or case.get("status") not in ("notrun", "disabled") else "skipped"


def tests(results):
    """Returns each test in a file with its outcome, or None without results."""
    try:
        cases = ElementTree.parse(results).getroot().iter("testcase")
    except (OSError, ElementTree.ParseError):
        return None
    return [(case, outcome(case)) for case in cases]


def print_count(results):
    found = collections.Counter(result for _, result in tests(results) or [])
    print(found["passed"], found["failed"] if found else 1, found["skipped"])


def print_failed(results):
    for case, result in tests(results) or []:
        if result == "failed":
            print(f"\n{results.stem}: {case.get('name')} failed")
            for line in (case.findtext("system-out") or "").rstrip().splitlines()[-LAST_LINES:]:
                print(f"    {line}")


def print_slowest_tests(files):
    times = [(float(case.get("time", 0)), f"{results.stem}: {case.get('name')}")
             for results in files for case, result in tests(results) or [] if result == "passed"]
    print(f"\nslowest of {len(times)} tests, which took {sum(time for time, _ in times):.0f} s in all:")
    for time, name in heapq.nlargest(SLOWEST, times):
        print(f"  {time:6.1f} s  {name}")


def compiled(builds, begin):
    """Yields (seconds, object file) from ninja's logs, for files written since `begin`."""
    for log in builds.glob("*/.ninja_log"):
        lines = log.read_text(encoding="utf-8").splitlines()[1:]
        for start, end, written, output, _ in (line.split("\t") for line in lines):
            if output.endswith(".o") and int(written) / 1e9 >= begin:
                yield (int(end) - int(start)) / 1000, f"{log.parent.name}: {output.replace('/CMakeFiles', '')}"


def print_slowest_files(builds, begin):
    times = sorted(set(compiled(builds, begin)), reverse=True)
    print(f"\nslowest of {len(times)} files compiled, which took {sum(time for time, _ in times):.0f} s in all:")
    for time, name in times[:SLOWEST]:
        print(f"  {time:6.1f} s  {name}")


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--count":
        print_count(pathlib.Path(arguments[1]))
        return
    if len(arguments) > 3 and arguments[0] == "--slowest":
        print_slowest_tests([pathlib.Path(name) for name in arguments[3:]])
        print_slowest_files(pathlib.Path(arguments[2]), float(arguments[1]))
        return
    for name in arguments:
        print_failed(pathlib.Path(name))


if __name__ == "__main__":
    main(sys.argv[1:])

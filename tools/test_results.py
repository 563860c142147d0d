#!/usr/bin/env python3
"""Reads results of ctest, JUnit files such as build/STAGE/tests.xml.

    test_results.py --count FILE     prints "PASSED FAILED SKIPPED"; no readable results are one failure
    test_results.py FILE...          prints the failed tests and the end of what each said, so that it stands where a
                                     long log ends; files that are missing or unreadable are skipped
"""
import collections
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

LAST_LINES = 40  # of what a test printed


def outcome(case):
    """Of one test; ctest says of a test whose program was not built that it was skipped, which is a failure here."""
    if case.get("status") == "run":
        return "passed"
    skipped = case.find("skipped")
    missing = skipped is not None and skipped.get("message", "").startswith("Unable to find")
    return "failed" if missing or case.get("status") not in ("notrun", "disabled") else "skipped"


def tests(results):
    """Each test in a file, with its outcome; None if there are no results."""
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
            print(f"\n{results.parent.name}: {case.get('name')} failed")
            for line in (case.findtext("system-out") or "").rstrip().splitlines()[-LAST_LINES:]:
                print(f"    {line}")


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--count":
        print_count(pathlib.Path(arguments[1]))
        return
    for name in arguments:
        print_failed(pathlib.Path(name))


if __name__ == "__main__":
    main(sys.argv[1:])

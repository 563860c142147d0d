#!/usr/bin/env python3
"""Damages valid files by one edit each, and gives them to octopair and to an independent reader.

    near_miss_test.py --reader PATH KIND...

What octopair accepts, the independent reader must accept, with the same values. What the independent reader accepts, octopair must accept.
A message of octopair is one line of text. The module of a kind (KINDS) makes valid files by the documentation, and reads files.

OCTOPAIR_TEST_SHARE sets the number of files in per cent of the usual number, and OCTOPAIR_TEST_CASES the number itself.
OCTOPAIR_TEST_SEED=N tests only file N, and shows it.
"""
import argparse
import collections
import os
import random
import re
import struct
import subprocess
import sys
import tempfile

import address
import client_token
import config_file
import csv_boxes
import exclusion_rules
import json_scene
import npy_header
import option_values
import role_file
import token_file
from damage import damaged
from values import Refused, same_words

USUAL_FILES = 2000
BATCH = 5000  # files that one process reads
VALID_EVERY = 10  # files that stay as they are
SHOWN_FAILURES = 5
KINDS = {"csv_boxes": csv_boxes, "npy_header": npy_header, "json_scene": json_scene, "exclusion_rules": exclusion_rules, "config_file": config_file,
         "count": option_values.Count, "bytes": option_values.Bytes, "length": option_values.Length, "token_file": token_file,
         "client_token": client_token, "role_file": role_file, "address": address}


class Case:
    """A file that is nearly valid. It depends only on its kind and its number."""

    def __init__(self, kind, number):
        source = random.Random(f"{kind} {number}")
        self.number, self.reader = number, KINDS[kind]
        self.data, self.edit = self.reader.make(source), "none"
        if number % VALID_EVERY:
            self.data, self.edit = damaged(source, self.data)

    def expected(self):
        """Returns the words of the independent reader, or nothing if it refuses the file."""
        try:
            return self.reader.read(self.data)
        except Refused:
            return None

    def must_be_accepted(self):
        """Returns whether octopair may not refuse a file that the independent reader accepts."""
        return not hasattr(self.reader, "is_plain") or self.reader.is_plain(self.data)

    def fault(self, answer):
        """Returns what is wrong with octopair's answer, or nothing."""
        expected = self.expected()
        verdict, _, rest = answer.partition(" ")
        if self.edit == "none" and expected is None:
            return "the independent reader refused a valid file"
        if verdict == "refused":
            if re.search("[\0-\x1f\x7f]", rest):
                return "the message has control characters"
            return "octopair refused a valid file" if expected is not None and self.must_be_accepted() else None
        if expected is None:
            return "octopair accepted a file that is not valid"
        return None if same_words(rest.split(), expected) else f"the values differ: {' '.join(expected)}"


def answers_of(reader, kind, cases, folder):
    """Returns octopair's answer to each case."""
    records = b"".join(struct.pack("<I", len(case.data)) + case.data for case in cases)
    done = subprocess.run([reader, kind, os.path.join(folder, "file")], input=records, capture_output=True, timeout=600, check=False)
    answers = done.stdout.decode("utf-8", "replace").split("\n")[:-1]
    if done.returncode or len(answers) != len(cases):
        print(done.stderr.decode("utf-8", "replace"))
        last = cases[min(len(answers), len(cases) - 1)]
        print(f"{kind}: the reader ended with status {done.returncode} near file {last.number}: {last.data!r}")
        return None
    return answers


def numbers_of_files():
    if "OCTOPAIR_TEST_SEED" in os.environ:
        return [int(os.environ["OCTOPAIR_TEST_SEED"])]
    share = int(os.environ.get("OCTOPAIR_TEST_SHARE", 100))
    return range(int(os.environ.get("OCTOPAIR_TEST_CASES", max(100, USUAL_FILES * share // 100))))


def test(reader, kind, numbers, folder):
    """Returns whether all files of a kind passed."""
    verdicts, failures = collections.Counter(), 0
    for begin in range(0, len(numbers), BATCH):
        cases = [Case(kind, number) for number in numbers[begin:begin + BATCH]]
        answers = answers_of(reader, kind, cases, folder)
        if answers is None:
            return False
        for case, answer in zip(cases, answers):
            verdicts[answer.split(" ")[0]] += 1
            fault = case.fault(answer)
            if fault or len(numbers) == 1:
                failures += fault is not None
                if failures <= SHOWN_FAILURES:
                    print(f"{kind}: file {case.number} (edit: {case.edit}): {fault or 'right'}\n  {case.data!r}\n  {answer}")
    print(f"{kind}: {len(numbers)} files: {verdicts['read']} accepted, {verdicts['refused']} refused, {failures} failed")
    # A test in which one of both never happens shows nothing.
    return not failures and (len(numbers) == 1 or min(verdicts["read"], verdicts["refused"]) >= len(numbers) // 20)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reader", required=True, help="the program octopair_near_miss_reader")
    parser.add_argument("kinds", nargs="+", choices=sorted(KINDS))
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        return 0 if all([test(arguments.reader, kind, numbers_of_files(), folder) for kind in arguments.kinds]) else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Tests the judgement of bench/guard on invented times, because building two commits takes too long for a test."""
import importlib.machinery
import importlib.util
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
PATH = pathlib.Path(__file__).resolve().parents[2] / "bench/guard"
LOADER = importlib.machinery.SourceFileLoader("guard", str(PATH))
guard = importlib.util.module_from_spec(importlib.util.spec_from_loader("guard", LOADER))
LOADER.exec_module(guard)

STEADY = ("uniform", 1000), ([50, 52, 51], [50, 51, 52])
SLOWER = ("rods", 1000), ([100, 100, 100], [120, 125, 90])
SLOWEST = ("flat", 1000), ([10, 10, 10], [30, 30, 30])
FASTER = ("dense", 1000), ([100, 100, 100], [50, 50, 50])


class Guard(unittest.TestCase):
    def test_steady_and_faster_pass(self):
        self.assertEqual(guard.judge(dict([STEADY, FASTER]), 1.10), [])

    def test_slowdowns_are_named_worst_first(self):
        slower = guard.judge(dict([SLOWER, STEADY, SLOWEST]), 1.10)
        self.assertEqual([scene for scene, _ in slower], [("flat", 1000), ("rods", 1000)])
        self.assertAlmostEqual(slower[1][1], 1.2)

    def test_the_bound_is_what_was_asked_for(self):
        self.assertEqual(guard.judge(dict([SLOWER]), 1.20), [])
        self.assertEqual(len(guard.judge(dict([SLOWER]), 1.19)), 1)

    def test_ratios_are_taken_round_by_round(self):
        # A machine that slows down during the rounds slows both commits. In each round the second is 1% slower.
        self.assertAlmostEqual(guard.ratio([10, 20, 40], [10.1, 20.2, 40.4]), 1.01)

    def test_report_says_which(self):
        times = dict([STEADY, SLOWER])
        text = guard.report(times, guard.judge(times, 1.10), 1.10)
        self.assertIn("rods              1000    100.00    120.00   1.200  slower", text)
        self.assertIn("slower: rods of 1000 by 20%", text)
        times = dict([STEADY])
        self.assertIn("no scene is slower by more than 10%", guard.report(times, guard.judge(times, 1.10), 1.10))


if __name__ == "__main__":
    unittest.main()

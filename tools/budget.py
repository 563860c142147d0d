#!/usr/bin/env python3
"""Compares what a run of scripts/test cost with tests/budget.

    budget.py [FILE]     fails if the plan itself does not fit into the time that there is; default: tests/budget

A line of tests/budget has the name of a stage, or "build" and the name of a preset, and its processor seconds with empty caches. Machines
differ, so a run is scaled by the time of a fixed program for the compiler: the line "machine" has its seconds on the machine of the other
lines.
"""
import os
import pathlib
import subprocess
import sys

FILE = pathlib.Path(__file__).resolve().parent.parent / "tests/budget"
CORES = 2
MOST_SECONDS = 3000  # of two busy cores, for all stages; the aim is 2,700
GREW = 1.15          # a stage that costs so many times its line is reported


def lines(file=FILE):
    """Returns the lines of a budget: names and seconds."""
    rows = (line.split("#")[0].rsplit(None, 1) for line in file.read_text(encoding="utf-8").splitlines())
    return {row[0].strip(): float(row[1]) for row in rows if len(row) == 2}


def speed_of_machine():
    """Returns the mean processor seconds of a compiler on each core at the same time, the least of three times.

    Compilers and tests mostly wait for memory and for the system, and slow each other down. So a computation in registers would not do.
    """
    program = b"#include <functional>\n#include <map>\n#include <regex>\nbool f(const char* s) { return std::regex_match(s, std::regex(s)); }\n"

    def once():
        command = ["g++", "-std=c++20", "-O1", "-c", "-x", "c++", "-", "-o", "/dev/null"]
        compilers = [subprocess.Popen(command, stdin=subprocess.PIPE) for _ in range(CORES)]
        for compiler in compilers:
            compiler.stdin.write(program)
            compiler.stdin.close()
        seconds = 0
        for compiler in compilers:
            _, status, usage = os.wait4(compiler.pid, 0)
            compiler.returncode = os.waitstatus_to_exitcode(status)
            seconds += usage.ru_utime + usage.ru_stime
        return seconds / CORES
    return min(once() for _ in range(3))


def print_comparison(run, machine):
    """Prints each build and stage that costs more than planned. Returns whether all of them fit into the time that there is."""
    planned = lines()
    scale = planned["machine"] / machine
    costs = {f"build {preset}": cost.processor * scale for preset, cost in run.builds.items()}
    costs.update({stage: cost.processor * scale for stage, cost in run.tests.items()})
    print(f"\nthis machine needs {1 / scale:.2f} times the seconds of tests/budget")
    for name, cost in costs.items():
        if name in planned and cost > GREW * planned[name] + 5:
            print(f"  {name} grew: {cost:.0f} processor seconds of that machine, planned are {planned[name]:.0f}")
    return fits(sum(costs.values()))


def fits(processor_seconds):
    """Prints how long two busy cores need for so many processor seconds. Returns whether this is short enough."""
    seconds = processor_seconds / CORES
    print(f"  in all {seconds:.0f} seconds of two busy cores; there are {MOST_SECONDS}")
    if seconds > MOST_SECONDS:
        print("  too many: make tests faster, merge them, or move them to --long")
    return seconds <= MOST_SECONDS


def main(words):
    planned = lines(*(pathlib.Path(word) for word in words[:1]))
    return 0 if fits(sum(cost for name, cost in planned.items() if name != "machine")) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

#!/usr/bin/env python3
"""Tests that the stages build what scripts/run left out of the same build folder: tests of these parts would be missing without a word."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import run_stages  # noqa: E402

left_out = re.findall(r"-D(OCTOPAIR_\w+)=OFF", (ROOT / "scripts/run").read_text(encoding="utf-8"))
assert {"OCTOPAIR_WITH_SERVICE", "OCTOPAIR_WITH_MPI", "OCTOPAIR_BUILD_TESTS"} <= set(left_out), left_out
for name, stage in {**run_stages.STAGES, **run_stages.LONG_STAGES}.items():
    options = run_stages.build_options([stage])
    for option in left_out:
        wanted = "OFF" if option == "OCTOPAIR_BUILD_BENCHMARKS" and option not in stage.options else "ON"
        assert f"-D{option}={wanted}" in options, f"stage {name}: {option} is not {wanted} in {options}"
print(f"{len(left_out)} options of scripts/run are set by all stages")

#!/usr/bin/env python3
"""Compares octopair's classes of pairs in a duplex house with the common volumes that another program computed (README.md).

    duplex_test.py PROGRAM     PROGRAM: octopair
"""
import csv
import json
import lzma
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
TOLERANCE = "0.001"


def unpack(folder):
    """Returns the model, unpacked into a folder."""
    model = folder / "duplex.obj"
    model.write_bytes(lzma.decompress((HERE / "duplex_arch_2x3.obj.xz").read_bytes()))
    return model


def detect(program, model, tolerance, threads):
    """Returns a file with the collisions of a model."""
    result = model.with_name(f"{tolerance}_{threads}.jsonl")
    options = ["--stage", "features", "--tolerance", tolerance, "--threads", str(threads)]
    subprocess.run([program, "detect", model, *options, "--output", result], check=True, stderr=subprocess.DEVNULL)
    return result


def rows_of(result):
    """Returns the rows of a file by the ids of their two elements."""
    rows = [json.loads(line) for line in result.read_text(encoding="utf-8").splitlines()]
    return {frozenset(row[label].split("/")[1] for label in ("a_label", "b_label")): row for row in rows}


def count(pairs, rows):
    """Returns how many pairs of each verdict have which class: {(verdict, class): number}. Pairs without a row have the class None."""
    counts = {}
    for pair, verdict in pairs.items():
        key = verdict, rows.get(pair, {}).get("class")
        counts[key] = counts.get(key, 0) + 1
    return counts


def main(program):
    with open(HERE / "duplex_arch_2x3.truth.csv", encoding="utf-8") as file:
        pairs = {frozenset((row["a"], row["b"])): row["verdict"] for row in csv.DictReader(file)}
    with tempfile.TemporaryDirectory() as folder:
        model = unpack(pathlib.Path(folder))
        exact = rows_of(detect(program, model, "0", 1))
        one, three = (detect(program, model, TOLERANCE, threads) for threads in (1, 3))
        assert one.read_bytes() == three.read_bytes(), "1 and 3 threads give different bytes"
        rows = rows_of(one)

    wanted = {("noise", "penetrating"): 247, ("real", "penetrating"): 59, ("between", "penetrating"): 19}
    assert count(pairs, exact) == wanted, f"tolerance 0: {count(pairs, exact)}"
    # All pairs between noise and real have a ball thicker than the tolerance: floors that reach into doors, beams into walls.
    wanted = {("noise", "touching"): 247, ("real", "penetrating"): 59, ("between", "penetrating"): 19}
    assert count(pairs, rows) == wanted, f"tolerance {TOLERANCE}: {count(pairs, rows)}"
    for pair, verdict in pairs.items():
        row = rows[pair]
        kind, thickness, limit = row["thickness_kind"], row["thickness"], float(TOLERANCE)
        right = kind == "at_most" and thickness <= limit if verdict == "noise" else kind == "at_least" and thickness > limit
        assert right, f"{verdict}: {row}"
    print(f"{len(pairs)} pairs have the right class")


if __name__ == "__main__":
    main(*sys.argv[1:])

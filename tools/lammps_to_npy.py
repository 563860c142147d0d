#!/usr/bin/env python3
"""Turns the atoms of a LAMMPS data file into spheres or boxes that octopair reads.

    lammps_to_npy.py INPUT.data[.gz] OUTPUT.npy [--repeat N] [--radius R] [--boxes]

Output    float32, C order: spheres (n, 4) as centre and radius, or with --boxes their boxes (n, 6).
Atoms     in the file's order, "Atoms # full" style (id, molecule, type, charge, x, y, z); coordinates as they stand
          (image flags are not applied). Repeated N x N x N by the periodic box's lengths, the last axis fastest.
Rounding  centre + i * length in float64, then once to float32; a box is that centre -/+ R in float32 arithmetic, which
          rounds to nearest. (octopair itself rounds the boxes of spheres outward, so its boxes contain these boxes.)
Only Python's standard library is used. The output file appears completely or not at all.
"""
import argparse
import array
import gzip
import itertools
import os
import sys


def read_atoms(path):
    """Returns the lengths of the periodic box and the coordinates of the atoms."""
    opener = gzip.open if path.endswith(".gz") else open
    lengths, atoms, count = {}, [], None
    with opener(path, "rt", encoding="utf-8") as lines:
        for line in lines:
            words = line.split()
            if words[1:] == ["atoms"]:
                count = int(words[0])
            elif len(words) == 4 and words[3] in ("xhi", "yhi", "zhi"):
                lengths[words[3]] = float(words[1]) - float(words[0])
            elif words[:1] == ["Atoms"]:
                if words[1:] not in ([], ["#", "full"]):
                    raise ValueError(f"{path}: atom style {' '.join(words[2:])}, expected full")
                break
        for line in lines:
            words = line.split()
            if words and not words[0].isdigit():
                break
            if words:
                atoms.append(tuple(float(word) for word in words[4:7]))
    if len(lengths) != 3 or count != len(atoms):
        raise ValueError(f"{path}: found {len(lengths)} box lengths and {len(atoms)} atoms, expected 3 and {count}")
    return [lengths[key] for key in ("xhi", "yhi", "zhi")], atoms


def repeated(lengths, atoms, repeat):
    """Returns the coordinates of all copies as a flat array, rounded to float32."""
    centres = array.array("f")
    for copy in itertools.product(range(repeat), repeat=3):
        shift = [i * length for i, length in zip(copy, lengths)]
        for atom in atoms:
            centres.extend((atom[0] + shift[0], atom[1] + shift[1], atom[2] + shift[2]))
    return centres


def rows_of(centres, radius, boxes):
    # float32 -/+ radius in float64 is exact enough that the one rounding to float32 equals float32 arithmetic.
    rows = array.array("f")
    for i in range(0, len(centres), 3):
        x, y, z = centres[i:i + 3]
        if boxes:
            rows.extend((x - radius, y - radius, z - radius, x + radius, y + radius, z + radius))
        else:
            rows.extend((x, y, z, radius))
    return rows


def write_npy(path, rows, columns):
    if sys.byteorder != "little":
        rows.byteswap()
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({len(rows) // columns}, {columns}), }}"
    header += " " * (-(10 + len(header) + 1) % 64) + "\n"
    temporary = f"{path}.{os.getpid()}.tmp"
    try:
        with open(temporary, "wb") as output:
            output.write(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode("ascii"))
            rows.tofile(output)
        os.replace(temporary, path)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("input")
    parser.add_argument("output")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--radius", type=float, default=1.0)
    parser.add_argument("--boxes", action="store_true")
    arguments = parser.parse_args()
    try:
        lengths, atoms = read_atoms(arguments.input)
        rows = rows_of(repeated(lengths, atoms, arguments.repeat), arguments.radius, arguments.boxes)
        write_npy(arguments.output, rows, 6 if arguments.boxes else 4)
    except (OSError, ValueError) as error:
        sys.exit(f"lammps_to_npy: {error}")


main()

#!/usr/bin/python3
"""Measures whole runs of the program, from files in the page cache to results in files: each run is a process of its own.

    bench/whole_runs.py PROGRAM --json FILE [--quick]

models        a search for colliding parts: rows by class, objects that are not closed, pairs that are undecided
meshes        a surface of a million triangles in several formats
large         ten and a hundred million boxes, counted
verification  what the check by a second algorithm takes for each kind of scene

Each row has the medians of its runs: seconds, processor seconds, and bytes at the peak of the resident size. The first line names
Debian's own Python, because scripts/setup installs NumPy for it.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODELS = ["IFC/AC14-FZK-Haus.ifc", "glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb", "OBJ/regr01.obj", "OBJ/spider.obj",
          "3DS/test1.3ds"]
KINDS = ["uniform", "dense", "mixed", "clustered", "flat", "world10", "plates-x", "sheets-x", "micro20", "far-outlier", "rods"]


class Runs:
    def __init__(self, program, folder, quick):
        self.program, self.folder, self.quick = program, folder, quick

    def measure(self, words, rounds):
        """Returns the medians of runs of `octopair detect`, and what the last one said about itself."""
        stats = self.folder / "stats.json"
        # The kernel counts the peak of a process from its fork on. So the shell forks, which is small.
        command = ["sh", "-c", '"$@"; exit $?', "sh", self.program, "detect", *map(str, words), "--quiet", "--stats", stats]
        seconds, processor, peaks = [], [], []
        for _ in range(1 if self.quick else rounds):
            begin = time.perf_counter()
            child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            if child.returncode != 0:
                sys.exit(f"whole_runs.py: {' '.join(map(str, command))} ended with status {child.returncode}")
            seconds.append(time.perf_counter() - begin)
            processor.append(usage.ru_utime + usage.ru_stime)
            said = json.loads(stats.read_text(encoding="utf-8"))
            peaks.append(said["peak_rss_bytes"])
        medians = {"seconds": statistics.median(seconds), "processor_seconds": statistics.median(processor),
                   "peak_bytes": statistics.median_high(peaks)}
        return medians, said

    def output(self, name):
        return "--output", self.folder / name

    def generate(self, kind, objects):
        path = self.folder / "boxes.npy"
        subprocess.run([self.program, "generate", kind, "--objects", str(objects), "--seed", "1", "--output", path, "--quiet"], check=True)
        return path


def models(runs):
    rows = []
    for name in MODELS[-2:] if runs.quick else MODELS:
        medians, stats = runs.measure([ROOT / "data" / "assimp_models" / name, "--stage", "features", *runs.output("rows.jsonl")], 5)
        rows.append({"model": name, "objects": stats["objects"], "penetrating": stats["classes"].get("penetrating", 0),
                     "touching": stats["classes"].get("touching", 0), "not_closed": stats.get("not_closed", 0),
                     "undecided": stats.get("undecided", 0), **medians})
    return rows


def torus(rings, sides):
    """Returns the vertices and the triangles of a torus in the plane z = 0, with radii 1 and 0.3."""
    around, across = numpy.meshgrid(numpy.arange(rings) * 2 * numpy.pi / rings, numpy.arange(sides) * 2 * numpy.pi / sides, indexing="ij")
    radius = 1 + 0.3 * numpy.cos(across)
    vertices = numpy.stack([radius * numpy.cos(around), radius * numpy.sin(around), 0.3 * numpy.sin(across)], axis=-1).reshape(-1, 3)
    i, j = numpy.meshgrid(numpy.arange(rings), numpy.arange(sides), indexing="ij")
    corner = [(((i + a) % rings) * sides + (j + b) % sides).ravel() for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return vertices, numpy.concatenate([numpy.stack([corner[k] for k in of], axis=1) for of in ((0, 1, 2), (0, 2, 3))])


def write_mesh(path, vertices, triangles):
    """Writes OBJ or OFF text with six decimals, or binary PLY with float64."""
    with open(path, "wb") as file:
        if path.suffix == ".obj":
            numpy.savetxt(file, vertices, "v %.6f %.6f %.6f")
            numpy.savetxt(file, triangles + 1, "f %d %d %d")
        elif path.suffix == ".off":
            file.write(f"OFF\n{len(vertices)} {len(triangles)} 0\n".encode())
            numpy.savetxt(file, vertices, "%.6f %.6f %.6f")
            numpy.savetxt(file, triangles, "3 %d %d %d")
        else:
            axes = "".join(f"property double {axis}\n" for axis in "xyz")
            file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{axes}element face {len(triangles)}\n"
                       "property list uchar int vertex_indices\nend_header\n".encode())
            file.write(vertices.astype("<f8").tobytes())
            faces = numpy.zeros(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
            faces["count"], faces["corners"] = 3, triangles
            file.write(faces.tobytes())


def meshes(runs):
    """Two meshes that cross, as two objects; and one mesh, each of whose triangles is an object."""
    rings, sides = (100, 50) if runs.quick else (1001, 500)
    vertices, triangles = torus(rings, sides // 2)
    whole = torus(rings, sides)
    rows = []
    for ending, what in ((".obj", "OBJ text"), (".off", "OFF text"), (".ply", "PLY binary, float64")):
        pair = [runs.folder / f"{name}{ending}" for name in ("first", "second")]
        for path, shift in zip(pair, (0, 0.5)):
            turned = shift > 0  # y and z change places, so the triangles turn round
            write_mesh(path, vertices[:, [0, 2, 1] if turned else [0, 1, 2]] + [shift, 0, 0], triangles[:, ::-1] if turned else triangles)
        words = [*pair, "--stage", "features", *runs.output("rows.jsonl")]
        rows.append(mesh_row(f"two meshes, {what}", 2 * len(triangles), runs.measure(words, 5)))
        if ending != ".ply":
            write_mesh(pair[0], *whole)
            words = [pair[0], "--objects", "triangle", *runs.output("rows.jsonl")]
            rows.append(mesh_row(f"one mesh, each triangle an object, {what}", len(whole[1]), runs.measure(words, 5)))
    return rows


def mesh_row(name, triangles, measured):
    medians, stats = measured
    return {"input": name, "triangles": triangles, "pairs": stats["pairs"], **medians}


def large(runs):
    rows = []
    for kind in ("uniform", "clustered"):
        for objects in [100_000] if runs.quick else [10_000_000, 100_000_000]:
            path = runs.generate(kind, objects)
            for threads in (1, 2):
                medians, stats = runs.measure([path, "--count-only", "--threads", threads], 2 if objects > 10_000_000 else 3)
                rows.append({"kind": kind, "objects": objects, "threads": threads, "pairs": stats["pairs"], **medians})
            path.unlink()
    return rows


def verification(runs):
    objects = 20_000 if runs.quick else 1_000_000
    rows = []
    for kind in KINDS:
        path = runs.generate(kind, objects)
        _, stats = runs.measure([path, "--verify", *runs.output("pairs.npy")], 1)
        seconds = stats["seconds"]
        rows.append({"kind": kind, "objects": objects, "pairs": stats["pairs"], "detect_seconds": seconds["detect"],
                     "verify_seconds": seconds["verify"]})
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", metavar="PROGRAM")
    parser.add_argument("--json", required=True)
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="octopair-runs-") as folder:
        runs = Runs(arguments.program, pathlib.Path(folder), arguments.quick)
        results = {"models": models(runs), "meshes": meshes(runs), "large": large(runs), "verification": verification(runs)}
    pathlib.Path(arguments.json).write_text(json.dumps(results, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()

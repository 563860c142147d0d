#!/usr/bin/python3
"""Compares calls of the Python package with the same calls of C++ and with SciPy.

    PYTHONPATH=build/release/python/package bench/python/compare.py LIBRARY [--objects N] [--rounds R] [--json FILE]

LIBRARY is liboctopair_python_calls_cpp.so of the build with benchmarks. All contenders run in one process and alternate; medians are compared.
"""
import argparse
import ctypes
import json
import statistics
import subprocess
import sys
import time

import numpy as np

import octopair as op

SIGNATURES = {
    "find_with_engine": (ctypes.c_double, [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint]),
    "find_at_once": (ctypes.c_double, [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint]),
    "make_scene": (None, [ctypes.c_void_p, ctypes.c_size_t]),
    "move_and_step": (ctypes.c_double, [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t]),
}


def load(path):
    library = ctypes.CDLL(path)
    for name, (result, arguments) in SIGNATURES.items():
        getattr(library, name).restype, getattr(library, name).argtypes = result, arguments
    return library


def seconds_of(call):
    begin = time.perf_counter()
    found = call()
    seconds = time.perf_counter() - begin
    del found
    return seconds


def alternate(rounds, **contenders):
    """Returns the median seconds of each contender. A contender returns its seconds."""
    times = {name: [] for name in contenders}
    for _ in range(rounds + 1):
        for name, run in contenders.items():
            times[name].append(run())
    return {name: statistics.median(values[1:]) for name, values in times.items()}


def compare_calls(library, boxes, rounds):
    count, at = len(boxes), boxes.ctypes.data
    engine = op.Engine()
    kept = alternate(rounds, cpp=lambda: library.find_with_engine(at, count, 0), python=lambda: seconds_of(lambda: engine.find_pairs(boxes)))
    once = alternate(rounds, cpp=lambda: library.find_at_once(at, count, 0), python=lambda: seconds_of(lambda: op.find_pairs(boxes)))
    return {"kept engine": kept, "short form": once, "outside": outside_seconds(engine, boxes, rounds)}


def outside_seconds(engine, boxes, rounds):
    """Returns the median time that a call of Python takes besides the call of C++ within."""
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        _, summary = engine.find_pairs(boxes, return_summary=True)
        times.append(time.perf_counter() - begin - summary.seconds)
    return statistics.median(times)


def compare_steps(library, boxes, rounds):
    rng = np.random.default_rng(1)
    mask = np.zeros(len(boxes), dtype=bool)
    mask[rng.choice(len(boxes), len(boxes) // 100, replace=False)] = True
    scene = op.Scene()
    ids = scene.add(boxes)
    scene.step()
    library.make_scene(boxes.ctypes.data, len(boxes))
    places = boxes[mask]
    states = {"cpp": places.copy(), "python": places.copy()}

    def moved(name):
        states[name] = states[name] + np.float32(1e-4) * rng.standard_normal((len(places), 1)).astype(np.float32)
        return states[name]

    def in_cpp():
        new = moved("cpp")
        return library.move_and_step(new.ctypes.data, mask.ctypes.data, len(new))

    def in_python():
        new = moved("python")

        def step():
            scene.move(ids[mask], new)
            return scene.step()

        return seconds_of(step)

    return alternate(rounds, cpp=in_cpp, python=in_python)


def compare_scipy(objects, rounds):
    from scipy.spatial import cKDTree
    rng = np.random.default_rng(1)
    # Centres and side are multiples of a power of two, so both searches compute exactly.
    centres = np.floor(rng.random((objects, 3)) * 2**20) / 2**20
    side = np.floor((1 / objects) ** (1 / 3) * 2**19) / 2**19
    boxes = np.hstack([centres - side / 2, centres + side / 2])
    engine = op.Engine(threads=1)
    theirs = cKDTree(centres).query_pairs(side, p=np.inf, output_type="ndarray")
    theirs = theirs[np.lexsort(theirs.T[::-1])]
    ours = engine.find_pairs(boxes)
    times = alternate(rounds, scipy=lambda: seconds_of(lambda: cKDTree(centres).query_pairs(side, p=np.inf, output_type="ndarray")),
                      octopair=lambda: seconds_of(lambda: engine.find_pairs(boxes)))
    return {**times, "pairs": len(ours), "same pairs": bool(np.array_equal(ours, theirs))}


def import_seconds(rounds):
    code = "import numpy, time; b = time.perf_counter(); import octopair; print(time.perf_counter() - b)"
    return statistics.median(float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
                             for _ in range(rounds))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("calls", metavar="LIBRARY")
    parser.add_argument("--objects", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--json")
    arguments = parser.parse_args()
    library = load(arguments.calls)
    boxes, few = op.generate("uniform", arguments.objects, seed=1), op.generate("uniform", min(10_000, arguments.objects), seed=1)
    results = {"objects": arguments.objects, "calls": compare_calls(library, boxes, arguments.rounds),
               "calls with 10,000 boxes": compare_calls(library, few, arguments.rounds * 20),
               "step with 1% moved": compare_steps(library, boxes, arguments.rounds),
               "SciPy": compare_scipy(arguments.objects, max(arguments.rounds // 5, 1)), "import": import_seconds(5)}
    for name in ("calls", "calls with 10,000 boxes"):
        print(f"{name}: {results[name]['outside'] * 1e6:.0f} us outside of the call of C++")
        for form in ("kept engine", "short form"):
            times = results[name][form]
            print(f"{name}, {form}: C++ {times['cpp'] * 1e3:.3f} ms, Python {times['python'] * 1e3:.3f} ms, "
                  f"ratio {times['python'] / times['cpp']:.3f}, overhead {(times['python'] - times['cpp']) * 1e6:.0f} us")
    step, scipy = results["step with 1% moved"], results["SciPy"]
    print(f"step with 1% moved: C++ {step['cpp'] * 1e3:.3f} ms, Python {step['python'] * 1e3:.3f} ms, ratio {step['python'] / step['cpp']:.3f}")
    print(f"SciPy {scipy['scipy']:.3f} s, octopair with 1 thread {scipy['octopair']:.3f} s, ratio {scipy['scipy'] / scipy['octopair']:.1f}, "
          f"{scipy['pairs']:,} pairs, {'the same' if scipy['same pairs'] else 'DIFFERENT'}")
    print(f"import octopair: {results['import'] * 1e3:.0f} ms beyond NumPy")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(results, file, indent=1)
    return 0 if scipy["same pairs"] else 1


if __name__ == "__main__":
    sys.exit(main())

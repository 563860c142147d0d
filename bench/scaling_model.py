#!/usr/bin/python3
"""A cost model of ranks, fitted to measurements of `octopair-bench cluster` (docs/scaling.md).

    scaling_model.py RESULTS > RESULTS/model.json     prints the tables that bench/page.py writes into docs/scaling.md

Costs of n evenly spread objects on k ranks, if entries of octants are sent:

    octants   o = v n                               octants of the octree, which every rank stores
    compute   (n / k) (a + b log2(n / k)) + d o + e k       seconds of a rank
    bytes     (16 w + f) (n / k) (k - 1) / k + g o + h k    sent by a rank; w: entries of an object; f: boxes of the sample
    messages  p (k - 1) + q                         sent by a rank
    network   messages x latency + bytes / bandwidth        seconds; a model, not measured

The constants are fitted to the runs on 10 and 40 ranks of some sizes, by least squares of relative errors; v and w
are means. The other runs check the constants. The model ends where a rank has fewer than three objects for each octant, because
then ranks send boxes.
"""
import json
import math
import pathlib
import sys

import numpy

CHECKED = {1_000_000, 2_000_000}  # numbers of objects of the runs that check the constants
FITTED_RANKS = {10, 40}  # numbers of ranks of the other runs
ENTRY = 16  # bytes of an entry in a message
NETWORKS = {"1 Gbit/s, 50 us": (50e-6, 125e6), "25 Gbit/s, 5 us": (5e-6, 3.125e9), "200 Gbit/s, 2 us": (2e-6, 25e9)}


def runs_of(results):
    """Returns the runs of uniform scenes."""
    runs = [run for name in ("cluster.json", "cluster_sizes.json")
            for run in json.loads((results / name).read_text(encoding="utf-8"))["runs"]]
    return [run for run in runs if run["scene"] == "uniform"]


def computing(run):
    """Returns the mean seconds of the ranks."""
    return sum(seconds for step, seconds in sorted(run["cpu_seconds"].items()) if step != "mpi") / run["ranks"]


def stored_octants(run):
    return run["octants"] / run["ranks"]


def per_rank(run, name):
    return run[name] / run["ranks"]


def fit(rows, values):
    """Fits constants by least squares of relative errors. Sets the most negative constant to 0 until none is negative."""
    rows, values = numpy.array(rows, float), numpy.array(values, float)
    used = list(range(rows.shape[1]))
    while True:
        found = numpy.linalg.lstsq(rows[:, used] / values[:, None], numpy.ones(len(values)), rcond=None)[0]
        if (found >= 0).all():
            constants = numpy.zeros(rows.shape[1])
            constants[used] = found
            return constants.tolist()
        del used[int(found.argmin())]


class Model:
    """Predictions of the model for a call."""

    def __init__(self, runs, all_runs):
        sizes = [(run["objects"], run["ranks"]) for run in runs]
        by_size = {run["objects"]: stored_octants(run) / run["objects"] for run in all_runs}
        self.v = sum(by_size.values()) / len(by_size)
        self.w = sum(run["entries"] / run["objects"] for run in runs) / len(runs)
        octants = [stored_octants(run) for run in runs]
        self.compute = fit([self.compute_row(n, k, o) for (n, k), o in zip(sizes, octants)],
                           [computing(run) for run in runs])
        self.sent = fit([[self.crossing(n, k), o, k] for (n, k), o in zip(sizes, octants)],
                        [per_rank(run, "bytes_sent") - ENTRY * self.w * self.crossing(*size)
                         for run, size in zip(runs, sizes)])
        self.told = fit([[k - 1, 1] for _, k in sizes], [per_rank(run, "messages_sent") for run in runs])

    def crossing(self, n, k):
        """Returns the number of objects whose entries a rank sends to other ranks."""
        return n / k * (k - 1) / k

    def octants(self, n):
        return self.v * n

    def compute_row(self, n, k, octants):
        own = n / k
        return [own, own * math.log2(own), octants, k]

    def seconds(self, n, k):
        """Returns the seconds for own objects, for the octree, and for other ranks."""
        own, logarithm, tree, ranks = (a * b for a, b in zip(self.compute, self.compute_row(n, k, self.octants(n))))
        return own + logarithm, tree, ranks

    def bytes(self, n, k):
        f, g, h = self.sent
        return (ENTRY * self.w + f) * self.crossing(n, k) + g * self.octants(n) + h * k

    def messages(self, k):
        return self.told[0] * (k - 1) + self.told[1]


def table(head, rows):
    return "\n".join([f"| {' | '.join(head)} |", f"|{'--:|' * len(head)}", *(f"| {' | '.join(row)} |" for row in rows)])


def constants_text(model):
    a, b, d, e = model.compute
    f, g, h = model.sent
    p, q = model.told
    return table(["v", "w", "a, ns", "b, ns", "d, ns", "e, us", "f", "g", "h", "p", "q"],
                 [[f"1 / {1 / model.v:,.0f}", f"{model.w:.2f}", f"{a * 1e9:.1f}", f"{b * 1e9:.2f}", f"{d * 1e9:.0f}",
                   f"{e * 1e6:.2f}", f"{f:.2f}", f"{g:.1f}", f"{h:,.0f}", f"{p:.1f}", f"{q:.0f}"]])


def check_text(model, runs):
    """Returns measured and predicted values of runs that were not used for the fit."""
    rows = []
    for run in sorted(runs, key=lambda run: (run["objects"], run["ranks"])):
        n, k = run["objects"], run["ranks"]
        pairs = [(computing(run) * 1e3, sum(model.seconds(n, k)) * 1e3, "{:.3f}"),
                 (stored_octants(run), model.octants(n), "{:,.0f}"),
                 (per_rank(run, "bytes_sent") * k / n, model.bytes(n, k) * k / n, "{:.1f}")]
        rows.append([f"{n:,}", str(k)] + [form.format(number) for measured, said, form in pairs for number in
                                          (measured, said)])
    return table(["objects", "ranks", "mean ms", "model", "octants", "model", "bytes an object", "model"], rows)


def far_text(model):
    """Returns predictions far beyond the measured range."""
    rows = []
    for n, k in ((10**8, 64), (10**9, 64), (10**9, 512), (10**10, 128), (10**10, 512)):
        objects, tree, ranks = model.seconds(n, k)
        networks = [model.messages(k) * latency + model.bytes(n, k) / bandwidth
                    for latency, bandwidth in NETWORKS.values()]
        rows.append([f"10^{round(math.log10(n))}", f"{k:,}", f"{model.octants(n):,.0f}",
                     *(f"{seconds * 1e3:,.1f}" for seconds in (objects, tree, ranks)),
                     f"{100 * objects / (objects + tree + ranks):.0f}%",
                     *(f"{seconds * 1e3:,.0f}" for seconds in networks)])
    return table(["objects", "ranks", "octants", "ms: own objects", "the octree", "other ranks", "own part", *NETWORKS],
                 rows)


def texts(results):
    """Returns the tables of docs/scaling.md."""
    runs = [run for run in runs_of(results) if run["ranks"] > 1]
    fitted = [run for run in runs if run["objects"] not in CHECKED and run["ranks"] in FITTED_RANKS]
    model = Model(fitted, runs)
    checked = [run for run in runs if run not in fitted]
    return {"model": constants_text(model), "model_check": check_text(model, checked), "model_far": far_text(model)}


if __name__ == "__main__":
    print(json.dumps(texts(pathlib.Path(sys.argv[1])), indent=2))

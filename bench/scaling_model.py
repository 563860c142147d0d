#!/usr/bin/python3
"""A cost model of ranks, fitted to measurements of `octopair-bench cluster` (docs/scaling.md).

    scaling_model.py RESULTS > RESULTS/model.json     prints the tables that bench/page.py writes into docs/scaling.md

Costs of n evenly spread objects on k ranks:

    shared    s = sigma (k / n)^(1/3)               fraction of the objects that several ranks receive: those at the
                                                    surface of a rank's part of the space
    received  r = (n / k) (1 + s)                   objects that a rank receives
    octants   o = min(u k + v n / k, v n)           octants that a rank stores, at most: the top of the octree and its own
    plan      c r + d o + e k                       seconds; e: work for each other rank
    compute   r (a + b log2 r) + m k                seconds of all other steps
    bytes     (26 + f) r (k - 1) / k + g k + h      sent by a rank; f: boxes of the sample
    messages  p (k - 1) + q                         sent by a rank
    network   messages x latency + bytes / bandwidth      seconds; a model, not measured

The constants are fitted to the runs on 10 and 40 ranks of some sizes, by least squares of relative errors; u and v are the largest
numbers of all runs. The other runs check the constants.
"""
import json
import math
import pathlib
import sys

import numpy

CHECKED = {1_000_000, 2_000_000}  # numbers of objects of the runs that check the constants
FITTED_RANKS = {10, 40}  # numbers of ranks of the other runs
BOX_AND_POSITION = 26  # bytes of an object in a message
NETWORKS = {"1 Gbit/s, 50 us": (50e-6, 125e6), "25 Gbit/s, 5 us": (5e-6, 3.125e9), "200 Gbit/s, 2 us": (2e-6, 25e9)}


def runs_of(results):
    """Returns the runs of uniform scenes."""
    runs = [run for name in ("cluster.json", "cluster_sizes.json")
            for run in json.loads((results / name).read_text(encoding="utf-8"))["runs"]]
    return [run for run in runs if run["scene"] == "uniform"]


def octant_bounds(runs):
    """Returns u and v. A run whose ranks store the whole octree does not bound u."""
    whole = {run["objects"]: stored_octants(run) for run in runs if run["ranks"] == 1}
    shared = [(stored_octants(run) - whole[run["objects"]] / run["ranks"]) / run["ranks"]
              for run in runs if run["ranks"] > 1 and stored_octants(run) < 0.9 * whole[run["objects"]]]
    return max(shared), max(octants / objects for objects, octants in whole.items())


def mean_seconds(run, steps):
    """Returns the mean seconds of the ranks in `steps`."""
    return sum(run["cpu_seconds"][step] for step in sorted(steps)) / run["ranks"]


def planning(run):
    return mean_seconds(run, ["plan"])


def computing(run):
    """Returns the mean seconds of all steps except planning."""
    return mean_seconds(run, set(run["cpu_seconds"]) - {"plan", "mpi"})


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

    def __init__(self, runs, tree):
        self.tree = tree
        self.sigma = fit([[(run["ranks"] / run["objects"]) ** (1 / 3)] for run in runs],
                         [per_rank(run, "shared_objects") * run["ranks"] / run["objects"] for run in runs])[0]
        sizes = [(run["objects"], run["ranks"]) for run in runs]
        self.plan = fit([[self.received(*size), stored_octants(run), size[1]] for run, size in zip(runs, sizes)],
                        [planning(run) for run in runs])
        self.compute = fit([self.compute_row(n, k) for n, k in sizes], [computing(run) for run in runs])
        self.sent = fit([[self.crossing(n, k), k, 1] for n, k in sizes],
                        [per_rank(run, "bytes_sent") - BOX_AND_POSITION * self.crossing(*size)
                         for run, size in zip(runs, sizes)])
        self.told = fit([[k - 1, 1] for _, k in sizes], [per_rank(run, "messages_sent") for run in runs])

    def shared(self, n, k):
        return min(1.0, self.sigma * (k / n) ** (1 / 3))

    def received(self, n, k):
        return n / k * (1 + self.shared(n, k))

    def crossing(self, n, k):
        """Returns the number of objects that a rank sends to other ranks."""
        return self.received(n, k) * (k - 1) / k

    def octants(self, n, k):
        u, v = self.tree
        return min(u * k + v * n / k, v * n)

    def compute_row(self, n, k):
        received = self.received(n, k)
        return [received, received * math.log2(received), k]

    def seconds(self, n, k):
        """Returns the seconds for received objects, for the tree, and for other ranks."""
        own, logarithm, ranks = (a * b for a, b in zip(self.compute, self.compute_row(n, k)))
        c, d, e = self.plan
        return own + logarithm + c * self.received(n, k), d * self.octants(n, k), ranks + e * k

    def bytes(self, n, k):
        f, g, h = self.sent
        return (BOX_AND_POSITION + f) * self.crossing(n, k) + g * k + h

    def messages(self, k):
        return self.told[0] * (k - 1) + self.told[1]


def table(head, rows):
    return "\n".join([f"| {' | '.join(head)} |", f"|{'--:|' * len(head)}", *(f"| {' | '.join(row)} |" for row in rows)])


def constants_text(model):
    a, b, m = model.compute
    u, v = model.tree
    c, d, e = model.plan
    f, g, h = model.sent
    p, q = model.told
    return table(["sigma", "u", "v", "a, ns", "b, ns", "c, ns", "d, ns", "e, us", "m, us", "f", "g", "h", "p", "q"],
                 [[f"{model.sigma:.2f}", f"{u:.0f}", f"1 / {1 / v:,.0f}", f"{a * 1e9:.1f}", f"{b * 1e9:.2f}",
                   f"{c * 1e9:.1f}", f"{d * 1e9:.0f}", f"{e * 1e6:.2f}", f"{m * 1e6:.2f}",
                   f"{f:.2f}", f"{g:.0f}", f"{h:,.0f}", f"{p:.1f}", f"{q:.0f}"]])


def check_text(model, runs):
    """Returns measured and predicted values of runs that were not used for the fit."""
    rows = []
    for run in sorted(runs, key=lambda run: (run["objects"], run["ranks"])):
        n, k = run["objects"], run["ranks"]
        pairs = [((planning(run) + computing(run)) * 1e3, sum(model.seconds(n, k)) * 1e3, "{:.3f}"),
                 (per_rank(run, "shared_objects") * k / n * 100, model.shared(n, k) * 100, "{:.2f}"),
                 (stored_octants(run), model.octants(n, k), "{:,.0f}"),
                 (per_rank(run, "bytes_sent") * k / n, model.bytes(n, k) * k / n, "{:.1f}")]
        rows.append([f"{n:,}", str(k)] + [form.format(number) for measured, said, form in pairs for number in
                                          (measured, said)])
    return table(["objects", "ranks", "mean ms", "model", "shared %", "model", "octants", "at most", "bytes an object",
                  "model"], rows)


def far_text(model):
    """Returns predictions far beyond the measured range."""
    rows = []
    for n, k in ((10**8, 64), (10**9, 512), (10**9, 4096), (10**10, 1024), (10**10, 4096)):
        objects, tree, ranks = model.seconds(n, k)
        networks = [model.messages(k) * latency + model.bytes(n, k) / bandwidth
                    for latency, bandwidth in NETWORKS.values()]
        rows.append([f"10^{round(math.log10(n))}", f"{k:,}", f"{model.octants(n, k):,.0f}",
                     *(f"{seconds * 1e3:,.1f}" for seconds in (objects, tree, ranks)),
                     f"{100 * objects / (objects + tree + ranks):.0f}%",
                     *(f"{seconds * 1e3:,.0f}" for seconds in networks)])
    return table(["objects", "ranks", "octants", "ms: own objects", "the tree", "other ranks", "own part", *NETWORKS], rows)


def texts(results):
    """Returns the tables of docs/scaling.md."""
    all_runs = runs_of(results)
    runs = [run for run in all_runs if run["ranks"] > 1]
    fitted = [run for run in runs if run["objects"] not in CHECKED and run["ranks"] in FITTED_RANKS]
    model = Model(fitted, octant_bounds(all_runs))
    checked = [run for run in runs if run not in fitted]
    return {"model": constants_text(model), "model_check": check_text(model, checked), "model_far": far_text(model)}


if __name__ == "__main__":
    print(json.dumps(texts(pathlib.Path(sys.argv[1])), indent=2))

#!/usr/bin/python3
"""Draws measured results as SVG.

    bench/plot.py FOLDER [--paper FILE] [--peers FILE...] [--scaling FILE...] [--cluster FILE]

Each FILE is the JSON of a program, reduced by bench/reduce_results.py. The pictures are written to FOLDER:

    --paper    octopair-bench paper      figure-5.svg, components.svg
    --peers    octopair_compare          peers-1m.svg, for a million objects on one thread
    --scaling  octopair-bench scaling    scaling.svg
    --cluster  octopair-bench cluster    cluster-efficiency.svg, cluster-steps.svg

Equal files give equal bytes. The first line names Debian's own Python, because scripts/setup bench installs Matplotlib
for this Python.
"""
import argparse
import json
import math
import pathlib

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot, ticker  # noqa: E402 (use() must precede this import)

# Palette of Okabe and Ito, distinguishable for colour-blind readers.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, RED, PURPLE = (
    "#000000", "#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")
LINES = [BLUE, RED, GREEN, PURPLE, ORANGE, SKY, BLACK]
GREY = "#555555"
PEERS = {"LBVH": GREEN, "Embree Morton": BLUE, "Embree SAH": SKY, "CGAL cutoff 1000": PURPLE, "Boost R-tree": YELLOW,
         "FCL AABB tree": ORANGE, "Bullet dbvt": RED, "paper": BLACK}
MILLION = 1_000_000
STYLE = {
    "svg.hashsalt": "octopair", "svg.fonttype": "none", "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"], "font.size": 10, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.axisbelow": True, "grid.color": "#dddddd", "grid.linewidth": 0.6, "figure.facecolor": "white",
    "axes.titlesize": 11, "legend.frameon": False, "legend.fontsize": 9,
}


def load(path):
    return json.loads(path.read_text(encoding="utf-8"))


def save(figure, folder, name):
    """Saves a figure on a white background, which is readable on dark pages, too."""
    figure.savefig(folder / name, facecolor="white", metadata={"Date": None, "Creator": None})
    pyplot.close(figure)


def setup_text(series):
    """Returns the label of a number of processors."""
    count, machines = series["processors"], series["machines"]
    if machines > 1:
        return f"{machines} x {count // machines} processors"
    return f"{count} processor{'s' if count > 1 else ''}"


def fit_curve(fits, objects):
    """Returns the name of the fit with the smaller residual, and its milliseconds at each number of objects."""
    linear, log = fits["n"], fits["n_log2_n"]
    if linear["residual"] <= log["residual"]:
        return "a n", [1e3 * linear["a"] * n for n in objects]
    return "a n log n", [1e3 * log["a"] * n * math.log2(n) for n in objects]


def draw_lines(axes, all_series):
    """Draws time against objects: a line for each number of processors, and its fit, dashed."""
    for series, color in zip(all_series, LINES):
        points = series["points"]
        millions = [point["objects"] / MILLION for point in points]
        axes.plot(millions, [point["median_seconds"] * 1e3 for point in points], "o-", color=color, markersize=4,
                  label=setup_text(series))
        largest = points[-1]["objects"]
        objects = [largest * i / 60 for i in range(1, 61)]
        name, curve = fit_curve(series["fits"], objects)
        what = "either fit; drawn" if series["fits"]["holds_better"] == "cannot tell" else "fit"
        axes.plot([n / MILLION for n in objects], curve, "--", color=color, linewidth=1, label=f"{what}: {name}")
    axes.set_xlabel("million objects")
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.yaxis.set_major_formatter(ticker.StrMethodFormatter("{x:,.0f}"))
    axes.legend(loc="upper left")


def figure_5(study, folder):
    """Draws the paper's figure 5 as measured: its algorithm and octopair, each with its own scale."""
    figure, panels = pyplot.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    titles = {"paper": "the paper's algorithm", "octopair": "octopair"}
    for axes, (finder, title) in zip(panels, titles.items()):
        draw_lines(axes, [series for series in study["series"] if series["finder"] == finder])
        axes.set_title(title)
    panels[0].set_ylabel("milliseconds")
    save(figure, folder, "figure-5.svg")


STEPS = [("octal codes (encode)", BLUE, "octal_codes", "encode"), ("sort (scatter)", ORANGE, "sort", "scatter"),
         ("merge (count)", GREEN, "merge_machine", "count"), ("merge at the master", PURPLE, "merge_master", None),
         ("scan", SKY, "scan", "scan")]


def component_bars(study):
    """Returns (label, seconds by step) for each bar."""
    published = study["published"]["components"]
    bars = [(f"as published, on\n{published['processors']}; no scan given",
             [published.get(paper, 0) / 1e6 for _, _, paper, _ in STEPS])]
    most = max(series["processors"] for series in study["series"])
    labels = {"paper": "the paper's here,\nradix sort", "paper, std::sort": "the paper's here,\nstd::sort",
              "octopair": "octopair"}
    for finder, label in labels.items():
        for series in study["series"]:
            if series["finder"] == finder and series["processors"] == most and series["machines"] == 1:
                steps = series["points"][-1]["median_steps"]
                bars.append((label, [steps.get(ours if finder == "octopair" else paper, 0)
                                     for _, _, paper, ours in STEPS]))
    return bars


def components(study, folder):
    """Draws a bar for each algorithm: the share of each step, with the total time as text."""
    bars = component_bars(study)
    figure, axes = pyplot.subplots(figsize=(9, 3.2), layout="constrained")
    left = [0.0] * len(bars)
    for i, (name, color, _, _) in enumerate(STEPS):
        shares = [100 * seconds[i] / sum(seconds) for _, seconds in bars]
        axes.barh(range(len(bars)), shares, left=left, color=color, label=name, height=0.62)
        for row, share in enumerate(shares):
            if share >= 5:
                axes.text(left[row] + share / 2, row, f"{share:.0f}%", ha="center", va="center", fontsize=9,
                          color="white" if color in (BLUE, GREEN) else "black")
        left = [a + b for a, b in zip(left, shares)]
    for row, (_, seconds) in enumerate(bars):
        axes.text(101, row, f"{sum(seconds) * 1e3:,.0f} ms", va="center", fontsize=9)
    axes.set_yticks(range(len(bars)), [label for label, _ in bars])
    axes.invert_yaxis()
    axes.set_xlim(0, 110)
    axes.set_xticks(range(0, 101, 20))
    axes.set_xlabel("% of the time of all steps")
    axes.grid(False, axis="y")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=len(STEPS))
    save(figure, folder, "components.svg")


def slower_by(result):
    """Returns the ratio of each peer's time to octopair's time in a scene."""
    seconds = {row["contender"]: row["median_seconds"] for row in result["rows"]
               if not row.get("out_of_memory") and "median_seconds" in row}
    return {name: seconds[name] / seconds["octopair"] for name in PEERS if name in seconds}


def draw_peers(axes, results):
    """Draws a group of bars for each scene."""
    width = 0.86 / len(PEERS)
    for i, (name, color) in enumerate(PEERS.items()):
        bars = [(scene + (i - (len(PEERS) - 1) / 2) * width, slower_by(result).get(name))
                for scene, result in enumerate(results)]
        bars = [(x, ratio) for x, ratio in bars if ratio]
        label = "the paper's algorithm" if name == "paper" else name
        axes.bar([x for x, _ in bars], [ratio - 1 for _, ratio in bars], width, bottom=1, color=color, label=label,
                 edgecolor="white", linewidth=0.4)
        for x, ratio in bars:
            axes.text(x, ratio * 1.05, f"{ratio:.0f}" if ratio >= 9.5 else f"{ratio:.1f}", ha="center", va="bottom",
                      fontsize=6.5, color=GREY)


def peers(results, folder):
    """Draws the ratios to octopair's time, on a logarithmic scale."""
    chosen = [r for r in results if r["objects"] == MILLION and r["threads"] == 1]
    if not chosen:
        return
    figure, axes = pyplot.subplots(figsize=(10, 4.2), layout="constrained")
    draw_peers(axes, chosen)
    axes.set_yscale("log")
    axes.set_ylim(bottom=min(1, *(0.8 * ratio for result in chosen for ratio in slower_by(result).values())))
    axes.set_xlim(-0.5, len(chosen) - 0.5)
    axes.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter(ticker.StrMethodFormatter("{x:g}"))
    axes.yaxis.set_minor_locator(ticker.NullLocator())
    axes.set_ylabel("times slower than octopair")
    axes.set_xticks(range(len(chosen)), [result["scene"] for result in chosen])
    axes.tick_params(axis="x", length=0)
    axes.grid(False, axis="x")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)
    save(figure, folder, "peers-1m.svg")


def core_axis(axes, counts, label):
    """Makes the axis logarithmic, with a mark at each count."""
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_locator(ticker.FixedLocator(sorted(counts)))
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    axes.xaxis.set_major_formatter(ticker.StrMethodFormatter("{x:g}"))
    axes.set_xlabel(label)


def panels(count):
    """Returns a figure with `count` panels, up to three in a row, and the panels."""
    columns = 2 if count in (2, 4) else min(count, 3)
    rows = math.ceil(count / columns)
    figure, grid = pyplot.subplots(rows, columns, figsize=(9, 3.2 * rows), squeeze=False, layout="constrained")
    for axes in grid.flat[count:]:
        axes.set_visible(False)
    return figure, list(grid.flat[:count])


def legend_above(figure, all_axes):
    """Adds a legend for all panels, with each label once."""
    labels = {label: handle for axes in all_axes for handle, label in zip(*axes.get_legend_handles_labels())}
    inches = 0.35
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - inches / figure.get_figheight()))
    figure.legend(labels.values(), labels.keys(), loc="upper center", ncols=len(labels))


def engine_text(row):
    """Returns the kind of engine: threads, ranks, or ranks of several threads."""
    if row["engine"] == "local":
        return "threads"
    return "ranks" if row["threads"] == 1 else f"ranks of {row['threads']} threads"


def draw_speedups(axes, result):
    """Draws a line for each kind of engine: objects in equal time, relative to one thread."""
    engines = {}
    for row in result["rows"]:
        engines.setdefault(engine_text(row), []).append(row)
    cores = sorted({row["cores"] for row in result["rows"]})
    axes.plot(cores, cores, "--", color=GREY, linewidth=1, label="each core as good as one")
    for (name, rows), color in zip(engines.items(), LINES):
        axes.plot([row["cores"] for row in rows], [row["speedup"] for row in rows], "o-", color=color, markersize=4,
                  label=name)
    core_axis(axes, cores, "cores")
    axes.set_yscale("log", base=2)
    axes.yaxis.set_major_formatter(ticker.StrMethodFormatter("{x:g}"))
    axes.set_title(f"{result['scene']}, {result['objects']:,}{' a core' if result['weak'] else ''}")


def scaling(results, folder):
    """Draws the speedup by cores, with a panel for each scene."""
    figure, all_axes = panels(len(results))
    for axes, result in zip(all_axes, results):
        draw_speedups(axes, result)
    figure.supylabel("times the objects of one thread", fontsize=10)
    legend_above(figure, all_axes)
    save(figure, folder, "scaling.svg")


RANK_STEPS = {"join": BLACK, "plan": GREEN, "route": PURPLE, "pack": YELLOW, "build": ORANGE, "merge": RED, "scan": SKY,
              "order": BLUE}


def calls_of(cluster):
    """Returns the runs by call and number of ranks, for calls that were also measured on one rank."""
    calls = {}
    for run in cluster["runs"]:
        name = f"{run['scene']}, {run['objects']:,}"
        if run.get("arrangement") == "paper":
            name += ", as in the paper"
        calls.setdefault(name, {})[run["ranks"]] = run
    return {name: runs for name, runs in calls.items() if 1 in runs}


def cluster_efficiency(cluster, folder):
    """Draws the efficiency: seconds of one rank over number of ranks times seconds of the slowest rank."""
    figure, axes = pyplot.subplots(figsize=(9, 3.8), layout="constrained")
    calls = calls_of(cluster)
    for i, (name, runs) in enumerate(calls.items()):
        one = runs[1]["slowest_seconds"]
        ranks = sorted(runs)
        shares = [100 * one / (k * runs[k]["slowest_seconds"]) for k in ranks]
        axes.plot(ranks, shares, "o-" if i < len(LINES) else "s--", color=LINES[i % len(LINES)], markersize=4, label=name)
    core_axis(axes, {k for runs in calls.values() for k in runs}, "ranks")
    axes.set_ylim(bottom=0)
    axes.set_ylabel("efficiency of the critical path, %")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    save(figure, folder, "cluster-efficiency.svg")


def draw_steps(axes, runs):
    """Draws a bar for each number of ranks, as high as that number times the slowest rank, with the sums of steps."""
    ranks = sorted(runs)
    bottom = [0.0] * len(ranks)
    for step, color in RANK_STEPS.items():
        sums = [1e3 * runs[k]["cpu_seconds"].get(step, 0) for k in ranks]
        if any(sums):
            axes.bar(range(len(ranks)), sums, 0.7, bottom=bottom, color=color, label=step)
        bottom = [a + b for a, b in zip(bottom, sums)]
    slowest = [1e3 * k * runs[k]["slowest_seconds"] for k in ranks]
    axes.bar(range(len(ranks)), [a - b for a, b in zip(slowest, bottom)], 0.7, bottom=bottom, color="#dddddd",
             label="behind the slowest")
    axes.set_xticks(range(len(ranks)), ranks)
    axes.set_xlabel("ranks")
    axes.yaxis.set_major_formatter(ticker.StrMethodFormatter("{x:,.0f}"))
    axes.grid(False, axis="x")


def cluster_steps(cluster, folder):
    """Draws the total costs of all ranks, with a panel for each call."""
    calls = calls_of(cluster)
    figure, all_axes = panels(len(calls))
    for axes, (name, runs) in zip(all_axes, calls.items()):
        draw_steps(axes, runs)
        axes.set_title(name)
    figure.supylabel("milliseconds of all ranks' processors", fontsize=10)
    legend_above(figure, all_axes)
    save(figure, folder, "cluster-steps.svg")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--paper", type=pathlib.Path, metavar="FILE")
    parser.add_argument("--peers", type=pathlib.Path, nargs="+", default=[], metavar="FILE")
    parser.add_argument("--scaling", type=pathlib.Path, nargs="+", default=[], metavar="FILE")
    parser.add_argument("--cluster", type=pathlib.Path, metavar="FILE")
    request = parser.parse_args()
    request.folder.mkdir(parents=True, exist_ok=True)
    pyplot.rcParams.update(STYLE)
    if request.paper:
        study = load(request.paper)
        figure_5(study, request.folder)
        components(study, request.folder)
    peers([result for path in request.peers for result in load(path)["results"]], request.folder)
    if request.scaling:
        scaling([result for path in request.scaling for result in load(path)["results"]], request.folder)
    if request.cluster:
        cluster_efficiency(load(request.cluster), request.folder)
        cluster_steps(load(request.cluster), request.folder)


if __name__ == "__main__":
    main()

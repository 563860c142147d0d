#!/usr/bin/env python3
"""Writes what was measured into a page: the text between <!-- begin NAME --> and <!-- end NAME -->.

    bench/page.py RESULTS PAGE

RESULTS: the folder that bench/results fills. What stands outside those marks is written by people and stays as it is. A
mark whose files are missing stays as well.
"""
import json
import pathlib
import re
import sys

ROWS = ["octopair", "octopair ascending", "octopair count", "octopair float64", "LBVH", "paper", "Embree Morton",
        "Embree SAH", "CGAL cutoff 1000", "CGAL cutoff 10", "FCL AABB tree", "FCL sweep and prune",
        "Boost R-tree", "Bullet dbvt", "ODE hash space", "sweep and prune"]


def load(path):
    return json.loads(path.read_text(encoding="utf-8"))


def machine(results):
    """What measured."""
    files = [load(path) for path in [results / "paper.json", *sorted(results.glob("peers_*.json"))]]
    said = files[0]
    commits = sorted({file["commit"] for file in files})
    return (f"Measured on {said['processor']}, {said['cores']} cores, with {said['compiler']}; octopair "
            f"{said['version']}, commit{'s' if len(commits) > 1 else ''} {', '.join(commits)}.")


def seconds_at(study, finder, processors, objects):
    for series in study["series"]:
        if (series["finder"], series["processors"], series["machines"]) == (finder, processors, 1):
            return {point["objects"]: point["median_seconds"] for point in series["points"]}.get(objects)
    return None


def short(results):
    """One table: a million objects, published, the paper's algorithm here, octopair."""
    study = load(results / "paper.json")
    million = 1_000_000
    published = next(table for table in study["published"]["tables"] if table["objects"] == million)
    times = {row["processors"]: row["microseconds"] / 1e6 for row in published["times"]}
    paper = seconds_at(study, "paper", 1, million)
    ours = seconds_at(study, "octopair", 1, million)
    rows = [("the paper, as published, 1 processor", times[1]), ("the paper, as published, 40 processors", times[40]),
            ("its algorithm here, 1 thread", paper), ("octopair here, 1 thread", ours)]
    lines = ["| 1,000,000 objects | seconds | against octopair |", "|---|--:|--:|"]
    lines += [f"| {name} | {seconds:.3f} | {seconds / ours:,.0f} x |" for name, seconds in rows]
    return "\n".join(lines)


def verbatim(text):
    return "\n".join(["```text", *text.rstrip("\n").splitlines(), "```"])


def paper(results):
    return verbatim((results / "paper.txt").read_text(encoding="utf-8"))


def scenes(results):
    return verbatim((results / "scenes.txt").read_text(encoding="utf-8"))


def cell(row, ours):
    """Milliseconds, and how many times slower than octopair."""
    if row is None:
        return "–"
    if "left_out_above" in row:
        return "left out"
    if row["out_of_memory"]:
        return "out of memory"
    seconds = row["median_seconds"]
    milliseconds = f"{seconds * 1e3:,.0f}" if seconds >= 0.1 else f"{seconds * 1e3:.1f}"
    ratio = seconds / ours
    times = f"{ratio:.0f}" if ratio >= 9.95 else f"{ratio:.1f}"
    if row["contender"] == "octopair":
        return milliseconds
    return f"{milliseconds} ({times} x)" + ("" if row["agrees"] else f", finds {row['pairs']:,} pairs")


def peers(results, name):
    """A table: contenders down, scenes across."""
    columns = []
    for result in load(results / f"peers_{name}.json")["results"]:
        rows = {row["contender"]: row for row in result["rows"]}
        columns.append((result["scene"], rows, rows["octopair"]["median_seconds"]))
    lines = ["| milliseconds | " + " | ".join(scene for scene, _, _ in columns) + " |",
             "|---|" + "--:|" * len(columns)]
    for contender in ROWS:
        if any(contender in rows for _, rows, _ in columns):
            cells = [cell(rows.get(contender), ours) for _, rows, ours in columns]
            label = "the paper's algorithm" if contender == "paper" else contender
            lines.append(f"| {label} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


BLOCKS = {"machine": machine, "short": short, "paper": paper, "scenes": scenes}
for table in ("1m_1", "1m_2", "100k_1", "100k_2", "10k_1", "real_1"):
    BLOCKS[f"peers_{table}"] = lambda results, table=table: peers(results, table)


def fill(page, results):
    """The page with every block written anew."""
    def block(match):
        name = match[1]
        try:
            text = BLOCKS[name](results)
        except FileNotFoundError as missing:
            print(f"page.py: {name} stays: no {missing.filename}", file=sys.stderr)
            return match[0]
        return f"<!-- begin {name} -->\n{text}\n<!-- end {name} -->"

    return re.sub(r"<!-- begin (\w+) -->\n.*?<!-- end \1 -->", block, page, flags=re.DOTALL)


def main(words):
    if len(words) != 2:
        sys.exit("page.py RESULTS PAGE")
    results, page = map(pathlib.Path, words)
    page.write_text(fill(page.read_text(encoding="utf-8"), results), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])

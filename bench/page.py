#!/usr/bin/env python3
"""Writes measured results into pages: the text between <!-- begin NAME --> and <!-- end NAME -->.

    bench/page.py [--check] RESULTS PAGE...

RESULTS: the folder that bench/results fills. Text outside the marks stays unchanged. A block whose
files are missing stays unchanged, too. With --check no page is written; the exit status is 1 if a page would change.
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
    """Returns the machine and build of the measurements."""
    others = [*sorted(results.glob("peers_*.json")), *results.glob("frames.json"), *results.glob("engines.json"),
              *results.glob("service.json")]
    files = [load(path) for path in [results / "paper.json", *others]]
    said = files[0]
    processors, versions, commits = (sorted({file[key] for file in files}) for key in ("processor", "version", "commit"))
    return (f"Measured on {' and '.join(processors)}, {said['cores']} cores, with {said['compiler']}; octopair "
            f"{' and '.join(versions)}, commit{'s' if len(commits) > 1 else ''} {', '.join(commits)}.")


def seconds_at(study, finder, processors, objects):
    for series in study["series"]:
        if (series["finder"], series["processors"], series["machines"]) == (finder, processors, 1):
            return {point["objects"]: point["median_seconds"] for point in series["points"]}.get(objects)
    return None


def short(results):
    """Returns a table for a million objects: published times, the paper's algorithm on this machine, octopair."""
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


def measured_on(said):
    """Returns the machine and build of a separate measurement."""
    return f"Measured on {said['processor']}, {said['cores']} cores, commit {said['commit']}.\n\n"


def machines(results):
    """Returns the machine of the measurement, and the tables."""
    return (measured_on(load(results / "machines.json"))
            + verbatim((results / "machines.txt").read_text(encoding="utf-8")))


def scenes(results):
    return verbatim((results / "scenes.txt").read_text(encoding="utf-8"))


def cell(row, ours):
    """Returns milliseconds, and the ratio to octopair."""
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
    """Returns a table with a row per contender and a column per scene."""
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


def milliseconds(seconds):
    """Formats milliseconds with at least two significant digits, down to a tenth of a microsecond."""
    value = seconds * 1e3
    return f"{value:,.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}" if value >= 0.1 else f"{value:.4f}"


TIMES = ("median_seconds", "percentile99_seconds", "slowest_seconds", "median_processor_seconds")


def case_title(case):
    """Describes a case of moving scenes, for the first cell of its rows."""
    moved = "all moved" if case["share"] == 1 else f"{case['share'] * 100:g}% moved"
    threads = f"{case['threads']} thread{'s' if case['threads'] > 1 else ''}"
    return f"{case['objects']:,}, {moved}, {threads}"


def frames(results):
    """Returns a row for each case and tracker, with the ratio to the scene with all pairs."""
    lines = ["| objects | milliseconds a frame | median | 99% | slowest | processor | against scene | frames/s |",
             "|---|---|--:|--:|--:|--:|--:|--:|"]
    for case in load(results / "frames.json")["results"]:
        scene = next(row["median_seconds"] for row in case["rows"] if row["tracker"] == "scene")
        title = case_title(case)
        most = max(row["frames"] for row in case["rows"])
        for row in case["rows"]:
            median = row["median_seconds"]
            times = [milliseconds(row[key]) for key in TIMES]
            name = row["tracker"] + (f", {row['frames']} frames" if row["frames"] < most else "")
            name += f", other pairs in {row['differing_frames']} frames" if row["differing_frames"] else ""
            ratio = f"{median / scene:.2f}" if median < 9.95 * scene else f"{median / scene:.0f}"
            rate = f"{1 / median:.1f}" if median > 0.1 else f"{1 / median:,.0f}"
            cells = [title, name, *times, f"{ratio} x", rate]
            lines.append("| " + " | ".join(cells) + " |")
            title = ""
    return "\n".join(lines)


def frame_queries(results):
    """Returns a row for each case with queries, with the microseconds of a query of each tracker."""
    cases = load(results / "frames.json")["results"]
    trackers = list(dict.fromkeys(row["tracker"] for case in cases for row in case["rows"] if "median_query_seconds" in row))
    lines = ["| microseconds a query: median (99%) | " + " | ".join(trackers) + " |", "|---|" + "--:|" * len(trackers)]
    for case in cases:
        rows = {row["tracker"]: row for row in case["rows"] if "median_query_seconds" in row}
        if rows:
            lines.append("| " + " | ".join([case_title(case), *(query_cell(rows[name]) if name in rows else "" for name in trackers)]) + " |")
    return "\n".join(lines)


def query_cell(row):
    """Returns the cell of a tracker's queries: their time, and in how many frames their answers differ."""
    times = f"{1e6 * row['median_query_seconds']:.2f} ({1e6 * row['percentile99_query_seconds']:.2f})"
    differing = row["differing_query_frames"]
    return times + (f", other numbers in {differing} frames" if differing else "")


def goal_text(goal):
    """Describes the ratio that a goal bounds."""
    against = goal["against"][0] if len(goal["against"]) == 1 else "the fastest peer"
    if goal["against"] == [goal["tracker"]]:
        return f"{goal['tracker']}: {goal['statistic']} frame / its median"
    return f"{goal['tracker']} / {against}"


def share_text(ratio):
    """Formats a ratio, or its inverse below 0.995."""
    return f"1/{1 / ratio:.3g}" if ratio < 0.995 else f"{ratio:.3g}"


def frame_goals(results):
    """Returns aims with the measured values."""
    lines = ["| objects | what | aim: at most | measured | processor | |", "|---|---|--:|--:|--:|---|"]
    for case in load(results / "frames.json")["results"]:
        for goal in case["goals"]:
            cells = [case_title(case), goal_text(goal), share_text(goal["most"]), share_text(goal["ratio"]),
                     share_text(goal["processor_ratio"]), "" if goal["ratio"] <= goal["most"] else "missed"]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def frame_memory(results):
    """Returns a table of bytes per object."""
    lines = ["| bytes an object | moved | pairs an object | peak, first frame | peak, later | steady | promised |",
             "|---|--:|--:|--:|--:|--:|--:|"]
    for row in load(results / "frames.json")["memory"]:
        objects = row["objects"]
        sizes = [f"{row[name] / objects:.0f}" for name in ("first_peak", "peak", "steady", "most")]
        cells = [row["scene"], f"{row['share'] * 100:g}%", f"{row['pairs'] / objects:.2f}", *sizes]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def engine_results(results):
    """Yields each contest with its description, for the first cell of its rows."""
    for contest in load(results / "engines.json")["results"]:
        yield f"{contest['scene']}, {contest['objects']:,}, {contest['order']}", contest


def engines(results):
    """Returns a row for each scene, order and engine, with the ratio to the local engine."""
    lines = ["| boxes, order | milliseconds | median | against local | first call | start of the engine |",
             "|---|---|--:|--:|--:|--:|"]
    for title, contest in engine_results(results):
        local = contest["rows"][0]["median_seconds"]
        for row in contest["rows"]:
            times = [milliseconds(row[key]) for key in ("median_seconds", "first_seconds", "start_seconds")]
            name = row["engine"] + ("" if row["agrees"] else ", other pairs")
            cells = [title, name, times[0], f"{row['median_seconds'] / local:.2f} x", *times[1:]]
            lines.append("| " + " | ".join(cells) + " |")
            title = ""
    return "\n".join(lines)


def aim_value(aim, value):
    """Formats the bound of an aim: a ratio, or milliseconds."""
    return f"{value:.2f}" if aim["measure"] == "ratio" else f"{value * 1e3:.2f} ms"


def engine_aims(results):
    """Returns aims with the measured times and memory."""
    lines = ["| boxes, order | what | aim | measured | |", "|---|---|--:|--:|---|"]
    for title, contest in engine_results(results):
        for aim in contest["aims"]:
            what = f"{aim['engine']} {'/' if aim['measure'] == 'ratio' else '-'} {aim['against']}"
            bound = f"at {'most' if aim['at_most'] else 'least'} {aim_value(aim, aim['bound'])}"
            cells = [title, what, bound, aim_value(aim, aim["reached"]), "" if aim["kept"] else "missed"]
            lines.append("| " + " | ".join(cells) + " |")
    for row in load(results / "engines.json")["memory"]:
        if "most_bytes" not in row:
            continue
        objects = row["objects"]
        cells = [f"{row['scene']}, {objects:,}, {row['order']}", f"{row['engine']}: bytes an object",
                 f"at most {row['most_bytes'] / objects:.0f}", f"{row['highest_bytes'] / objects:.0f}",
                 "" if row["highest_bytes"] <= row["most_bytes"] else "missed"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def engine_memory(results):
    """Returns bytes per object over all processes, beyond boxes and pairs."""
    lines = ["| boxes, order | engine | engine alone, MB | bytes an object: kept | highest |", "|---|---|--:|--:|--:|"]
    for row in load(results / "engines.json")["memory"]:
        objects = row["objects"]
        sizes = [f"{row[name] / objects:.0f}" for name in ("kept_bytes", "highest_bytes")]
        cells = [f"{row['scene']}, {objects:,}, {row['order']}", row["engine"], f"{row['idle_bytes'] / 1e6:.1f}",
                 *sizes]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def engine_choice(results):
    """Compares the engines local and processes in octal order, to help users choose."""
    lines = ["| milliseconds | local | processes | difference |", "|---|--:|--:|--:|"]
    starts = {}
    for _, contest in engine_results(results):
        if contest["order"] != "octal":
            continue
        rows = {row["engine"]: row for row in contest["rows"]}
        local, other = (rows[name]["median_seconds"] for name in ("local", "processes"))
        starts = {name: milliseconds(rows[name]["start_seconds"]) for name in ("local", "processes")}
        cells = [f"{contest['objects']:,} boxes, {contest['scene']}", milliseconds(local), milliseconds(other),
                 milliseconds(other - local)]
        lines.append("| " + " | ".join(cells) + " |")
    lines.append(f"| to make the engine | {starts['local']} | {starts['processes']} | |")
    return "\n".join(lines)


def service(results):
    """Returns a row for each job and order, and for a frame of a scene: locally, and on a server."""
    study = load(results / "service.json")
    lines = ["| milliseconds | local | on a server | against local | `submit()` |", "|---|--:|--:|--:|--:|"]
    rows = [(f"{row['objects']:,} boxes, {row['order']}", row) for row in study["against_local"]]
    scene = study["scene"]
    rows.append((f"a frame of a scene of {scene['objects']:,}, {scene['moved']:,} moved", scene))
    for title, row in rows:
        local, remote = row["local_seconds"], row["remote_seconds"]
        submit = f"{row['submit_seconds'] * 1e3:.3f}" if "submit_seconds" in row else ""
        same = "" if row["same"] else ", other pairs"
        cells = [title + same, milliseconds(local), milliseconds(remote), f"{remote / local:.2f} x", submit]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def service_crowds(results):
    """Returns a table for many concurrent clients."""
    lines = ["| clients | boxes a job | jobs | wrong or lost | jobs a second | ms: median | 99% | slowest |",
             "|--:|--:|--:|--:|--:|--:|--:|--:|"]
    for row in load(results / "service.json")["crowds"]:
        times = [milliseconds(row[key]) for key in ("median_seconds", "p99_seconds", "slowest_seconds")]
        cells = [row["clients"], f"{row['objects']:,}", f"{row['jobs']:,}", row["wrong"],
                 f"{row['jobs_per_second']:,.0f}", *times]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def service_aims(results):
    """Returns aims with the measured values."""
    lines = ["| what | aim | measured | |", "|---|--:|--:|---|"]
    for aim in load(results / "service.json")["aims"]:
        cells = [aim["what"], f"at {'most' if aim['at_most'] else 'least'} {aim['bound']:,g}", f"{aim['reached']:,.3g}"
                 if aim["reached"] < 1000 else f"{aim['reached']:,.0f}", "" if aim["kept"] else "missed"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def scaling_results(results):
    """Yields each scene with its title."""
    for path in [results / "scaling.json", *results.glob("scaling_weak.json")]:
        for result in load(path)["results"]:
            yield f"{result['scene']}, {result['objects']:,}{' a core' if result['weak'] else ''}", result


def scaling(results):
    """Returns a row for each number of threads and of ranks on each scene."""
    lines = ["| scene, objects | on | milliseconds | times one thread | efficiency | against threads |",
             "|---|---|--:|--:|--:|--:|"]
    for title, result in scaling_results(results):
        for row in result["rows"]:
            threads = f"{row['threads']} thread{'s' if row['threads'] > 1 else ''}"
            ranks = f"{row['ranks']} rank{'s' if row['ranks'] > 1 else ''}"
            on = threads if row["engine"] == "local" else ranks if row["threads"] == 1 else f"{ranks} x {threads}"
            against = f"{row['against_threads']:.2f} x" if "against_threads" in row else ""
            cells = [title, on, milliseconds(row["median_seconds"]), f"{row['speedup']:.2f}",
                     f"{100 * row['efficiency']:.0f}%", against]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def scaling_aims(results):
    """Returns aims of ranks against threads, with the measured values."""
    lines = ["| scene, objects | what | aim | measured | |", "|---|---|--:|--:|---|"]
    for title, result in scaling_results(results):
        for aim in result["aims"]:
            many = "s" if aim["cores"] > 1 else ""
            cells = [title, f"{aim['cores']} rank{many} / {aim['cores']} thread{many}", f"at most {aim['most']:g} x",
                     f"{aim['reached']:.2f} x", "" if aim["kept"] else "missed"]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def cluster(results):
    """Returns a row for each number of ranks in each call."""
    lines = ["| scene, objects | ranks | slowest, ms | ns x ranks / object | imbalance | efficiency | bytes an object | octants |",
             "|---|--:|--:|--:|--:|--:|--:|--:|"]
    study = load(results / "cluster.json")
    runs = study["runs"] + load(results / "cluster_sizes.json")["runs"] + load(results / "cluster_regions.json")["runs"]
    arrangements = {"shared": "", "space": ", sorted", "blocks": ", in blocks", "paper": ", as in the paper"}

    def call(run):
        return run["scene"], run["objects"], run.get("arrangement", "shared")

    one = {call(run): run["slowest_seconds"] for run in runs if run["ranks"] == 1}
    for run in sorted(runs, key=call):
        slowest, ranks = run["slowest_seconds"], run["ranks"]
        efficiency = f"{100 * one[call(run)] / (ranks * slowest):.1f}%" if call(run) in one else "–"
        cells = [f"{run['scene']}, {run['objects']:,}{arrangements[call(run)[2]]}", str(ranks), milliseconds(slowest),
                 f"{slowest * 1e9 * ranks / run['objects']:.1f}", f"{slowest * ranks / run['computing_seconds']:.3f}",
                 efficiency, f"{run['bytes_sent'] / run['objects']:.1f}",
                 f"{run['most_octants']:,}"]
        lines.append("| " + " | ".join(cells) + " |")
    return measured_on(study["machine"]) + "\n".join(lines)


def median(numbers):
    return sorted(numbers)[len(numbers) // 2]


def exact_objects(results):
    """Returns a table for instances of a mesh, compared with FCL."""
    first = load(results / "exact_objects_1.json")
    rows = [(f"octopair, {study['threads']} thread{'s' if study['threads'] > 1 else ''}",
             median(study["octopair_seconds"]), median(study["fcl_seconds"]))
            for study in map(load, sorted(results.glob("exact_objects_*.json")))]
    lines = [f"| {first['objects']:,} objects of {first['triangles']:,} triangles, {first['collisions']:,} collisions | "
             "milliseconds | FCL, one thread, in the same turns | FCL / octopair |", "|---|--:|--:|--:|"]
    lines += [f"| {name} | {ours * 1e3:,.0f} | {theirs * 1e3:,.0f} | {theirs / ours:.1f} |"
              for name, ours, theirs in rows]
    return measured_on(first["machine"]) + "\n".join(lines)


def self_intersections(results):
    """Returns a table for triangles of one mesh, compared with CGAL."""
    study = load(results / "self_intersections.json")
    ours = study["contenders"][0]["median_seconds"]
    lines = [f"| {study['triangles']:,} triangles, {study['pairs']:,} pairs that meet, {study['threads']} threads | "
             "milliseconds | / octopair |", "|---|--:|--:|"]
    lines += [f"| {row['name']}{'' if row['agrees'] else ' (finds other pairs)'} | {row['median_seconds'] * 1e3:,.0f} | "
              f"{row['median_seconds'] / ours:.1f} |" for row in study["contenders"]]
    return measured_on(study["machine"]) + "\n".join(lines)


def model(name):
    """Returns a function that loads a table of bench/scaling_model.py."""
    return lambda results: load(results / "model.json")[name]


BLOCKS = {"machine": machine, "short": short, "paper": paper, "machines": machines, "scenes": scenes, "frames": frames,
          "frame_queries": frame_queries, "frame_goals": frame_goals, "frame_memory": frame_memory,
          "engines": engines, "engine_aims": engine_aims,
          "engine_memory": engine_memory, "engine_choice": engine_choice, "service": service,
          "service_crowds": service_crowds, "service_aims": service_aims,
          "exact_objects": exact_objects, "self_intersections": self_intersections, "scaling": scaling,
          "scaling_aims": scaling_aims, "cluster": cluster, "model": model("model"),
          "model_check": model("model_check"), "model_far": model("model_far")}
for table in ("1m_1", "1m_2", "100k_1", "100k_2", "10k_1", "real_1"):
    BLOCKS[f"peers_{table}"] = lambda results, table=table: peers(results, table)


def fill(page, results):
    """Returns the page with every block rewritten."""
    def block(match):
        name = match[1]
        try:
            text = BLOCKS[name](results)
        except FileNotFoundError as missing:
            print(f"page.py: block {name} is unchanged: {missing.filename} does not exist", file=sys.stderr)
            return match[0]
        return f"<!-- begin {name} -->\n{text}\n<!-- end {name} -->"

    return re.sub(r"<!-- begin (\w+) -->\n.*?<!-- end \1 -->", block, page, flags=re.DOTALL)


def main(words):
    check = words[:1] == ["--check"]
    if len(words) < check + 2:
        sys.exit("page.py [--check] RESULTS PAGE...")
    results, *pages = map(pathlib.Path, words[check:])
    wrong = 0
    for page in pages:
        before = page.read_text(encoding="utf-8")
        after = fill(before, results)
        if check and after != before:
            print(f"{page}: a table differs from {results}: run bench/page.py {results} {page}", file=sys.stderr)
            wrong = 1
        elif after != before:
            page.write_text(after, encoding="utf-8")
    return wrong


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

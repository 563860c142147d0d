"""Tables of the pages, from the results of bench/results. Each function of BLOCKS returns the text of a block (bench/page.py)."""
import json

import origin

ROWS = ["octopair", "octopair ascending", "octopair count", "octopair float64", "LBVH", "paper", "Embree Morton",
        "Embree SAH", "CGAL cutoff 1000", "CGAL cutoff 10", "FCL AABB tree", "FCL sweep and prune",
        "Boost R-tree", "Bullet dbvt", "ODE hash space", "sweep and prune"]


def load(path):
    return json.loads(path.read_text(encoding="utf-8"))


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
            cells = [query_cell(rows[name]) if name in rows else "" for name in trackers]
            lines.append("| " + " | ".join([case_title(case), *cells]) + " |")
    return "\n".join(lines)


def query_cell(row):
    """Returns the cell of a tracker's queries: their time, and in how many frames their answers differ."""
    times = f"{1e6 * row['median_query_seconds']:.2f} ({1e6 * row['percentile99_query_seconds']:.2f})"
    differing = row["differing_query_frames"]
    return times + (f", other numbers in {differing} frames" if differing else "")


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
    return "\n".join(lines)


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
    return "\n".join(lines)


def self_intersections(results):
    """Returns a table for triangles of one mesh, compared with CGAL."""
    study = load(results / "self_intersections.json")
    ours = study["contenders"][0]["median_seconds"]
    lines = [f"| {study['triangles']:,} triangles, {study['pairs']:,} pairs that meet, {study['threads']} threads | "
             "milliseconds | / octopair |", "|---|--:|--:|"]
    lines += [f"| {row['name']}{'' if row['agrees'] else ' (finds other pairs)'} | {row['median_seconds'] * 1e3:,.0f} | "
              f"{row['median_seconds'] / ours:.1f} |" for row in study["contenders"]]
    return "\n".join(lines)


def model(name):
    """Returns a function that loads a table of bench/scaling_model.py."""
    return lambda results: load(results / "model.json")[name]


def text_of(name):
    """Returns a function that shows the output of a program as it is."""
    return lambda results: verbatim("\n".join(load(results / f"{name}.json")["text"]))


def origin_sentence(results):
    return origin.sentence(results / "paper.json")


def case_rows(results, objects, share, threads=1):
    """Returns the rows of a case of moving scenes by tracker."""
    case = next(case for case in load(results / "frames.json")["results"]
                if (case["objects"], case["share"], case["threads"]) == (objects, share, threads))
    return {row["tracker"]: row for row in case["rows"]}


def scene_rows(results, name, scene):
    """Returns the rows of a comparison with peers by contender."""
    result = next(result for result in load(results / f"peers_{name}.json")["results"] if result["scene"] == scene)
    return {row["contender"]: row for row in result["rows"] if "median_seconds" in row}


OURS = ("octopair", "octopair ascending", "octopair count", "octopair float64", "full detection", "scene", "scene, changes only",
        "LBVH", "paper", "sweep and prune")  # the others are libraries


def next_best(rows):
    """Returns the name of the fastest library, and its seconds."""
    name = min((name for name in rows if name not in OURS and not name.startswith("limit")), key=lambda name: rows[name]["median_seconds"])
    return name, rows[name]["median_seconds"]


def duration(seconds):
    """Formats a time with two or three significant digits, in the unit that fits it."""
    value, unit = (seconds * 1e6, "µs") if seconds < 1e-3 else (seconds * 1e3, "ms") if seconds < 1 else (seconds, "s")
    return f"{value:.0f} {unit}" if value >= 10 else f"{value:.1f} {unit}"


def factor(theirs, ours):
    ratio = theirs / ours
    return f"{ratio:.0f} x" if ratio >= 9.95 else f"{ratio:.1f} x"


def peers_short(results):
    """Returns three rows: a step of 1,000 bodies that all move, and all pairs of 100,000 and a million boxes in the default order."""
    lines = ["| objects, one thread | octopair | next best | factor |", "|---|--:|--:|--:|"]
    entries = [("1,000 bodies that all move, a step", "scene", case_rows(results, 1000, 1))]
    entries += [(f"{objects:,} uniform boxes, all pairs", "octopair ascending", scene_rows(results, name, "uniform"))
                for name, objects in (("100k_1", 100_000), ("1m_1", 1_000_000))]
    for title, ours, rows in entries:
        name, theirs = next_best(rows)
        seconds = rows[ours]["median_seconds"]
        lines.append(f"| {title} | {duration(seconds)} | {duration(theirs)} ({name}) | {factor(theirs, seconds)} |")
    return "\n".join(lines)


def small_worlds(results):
    """Returns a row for each tracker of 1,000 bodies that all move: median and 99th percentile of a step."""
    rows = case_rows(results, 1000, 1)
    ours = rows["scene"]["median_seconds"]
    lines = ["| 1,000 bodies that all move, one thread | median, ms | 99%, ms | |", "|---|--:|--:|--:|"]
    for name in ("scene", "full detection", *(name for name in rows if name not in OURS)):
        row = rows[name]
        title = {"scene": "octopair: `Scene`", "full detection": "octopair: `find_pairs`"}.get(name, name)
        ratio = "" if name == "scene" else factor(row["median_seconds"], ours)
        lines.append(f"| {title} | {milliseconds(row['median_seconds'])} | {milliseconds(row['percentile99_seconds'])} | {ratio} |")
    return "\n".join(lines)


def peers_summary(results):
    """Returns a row for each number of objects and scene: octopair in octal and in ascending order, and the fastest library."""
    lines = ["| all pairs, one thread | octopair, ms | in ascending order | next best library, ms | / ascending |", "|---|--:|--:|--:|--:|"]
    for name, objects in (("10k_1", 10_000), ("100k_1", 100_000), ("1m_1", 1_000_000)):
        for result in load(results / f"peers_{name}.json")["results"]:
            if result["scene"] in ("uniform", "dense", "clustered"):
                rows = scene_rows(results, name, result["scene"])
                library, theirs = next_best(rows)
                octal, ascending = (rows[name]["median_seconds"] for name in ("octopair", "octopair ascending"))
                lines.append(f"| {objects:,}, {result['scene']} | {milliseconds(octal)} | {milliseconds(ascending)} | "
                             f"{milliseconds(theirs)} ({library}) | {factor(theirs, ascending)} |")
    return "\n".join(lines)


def frames_summary(results):
    """Returns a row for each case: medians of a full detection, of a step of a scene, and of the fastest library."""
    lines = ["| objects | full detection, ms | step of a `Scene`, ms | full / step | next best library | ms | / step |",
             "|---|--:|--:|--:|---|--:|--:|"]
    for case in load(results / "frames.json")["results"]:
        rows = {row["tracker"]: row for row in case["rows"]}
        full, step = (rows[name]["median_seconds"] for name in ("full detection", "scene"))
        library = next_best(rows) if any(name not in OURS for name in rows) else None
        theirs = [library[0], milliseconds(library[1]), factor(library[1], step)] if library else ["", "", ""]
        lines.append("| " + " | ".join([case_title(case), milliseconds(full), milliseconds(step), f"{full / step:.2g}", *theirs]) + " |")
    return "\n".join(lines)


def same_call(results):
    """Returns the range of the times of the same call in several tables."""
    study = load(results / "scaling.json")["results"]
    weak = load(results / "scaling_weak.json")["results"]
    times = [scene_rows(results, "1m_1", "uniform")["octopair"]["median_seconds"]]
    times += [row["median_seconds"] for result in (*study, *weak) if (result["scene"], result["objects"]) == ("uniform", 1_000_000)
              for row in result["rows"] if (row["engine"], row["threads"]) == ("local", 1)]
    line = next(line for line in load(results / "scenes.json")["text"] if line.startswith("uniform") and "float32" in line)
    times.append(float(line.split()[3]) / 1e3)
    return (f"One call stands in several tables, each time measured anew: a million `uniform` boxes, octal order, one thread, took "
            f"{milliseconds(min(times))} to {milliseconds(max(times))} ms.")


def megabytes(count):
    return f"{count / 1e6:,.0f}"


def models(results):
    """Returns a row for each real model: its objects and rows by class."""
    lines = ["| model | objects | penetrating | touching | not closed | undecided | seconds | MB at the peak |", "|---|" + "--:|" * 7]
    for row in load(results / "files.json")["models"]:
        cells = [f"`{row['model']}`", *(f"{row[name]:,}" for name in ("objects", "penetrating", "touching", "not_closed", "undecided")),
                 f"{row['seconds']:.2f}", megabytes(row["peak_bytes"])]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def meshes(results):
    """Returns a row for each format of a large mesh."""
    lines = ["| input | triangles | seconds | processor | MB at the peak |", "|---|--:|--:|--:|--:|"]
    for row in load(results / "files.json")["meshes"]:
        lines.append(f"| {row['input']} | {row['triangles']:,} | {row['seconds']:.2f} | {row['processor_seconds']:.2f} | "
                     f"{megabytes(row['peak_bytes'])} |")
    return "\n".join(lines)


def large(results):
    """Returns a row for each large scene: a whole run that counts its pairs."""
    lines = ["| boxes | threads | pairs | seconds | ns an object | bytes an object beside the 24 of its box |", "|---|--:|--:|--:|--:|--:|"]
    for row in load(results / "files.json")["large"]:
        objects = row["objects"]
        lines.append(f"| {row['kind']}, {objects:,} | {row['threads']} | {row['pairs']:,} | {row['seconds']:.2f} | "
                     f"{row['seconds'] / objects * 1e9:.0f} | {row['peak_bytes'] / objects - 24:.0f} |")
    return "\n".join(lines)


def verification(results):
    """Returns a row for each kind of scene: the call, and the check of its result."""
    rows = load(results / "files.json")["verification"]
    lines = [f"| {rows[0]['objects']:,} boxes | pairs | call, seconds | check, seconds | check / call |", "|---|--:|--:|--:|--:|"]
    for row in rows:
        call, check = row["detect_seconds"], row["verify_seconds"]
        lines.append(f"| {row['kind']} | {row['pairs']:,} | {call:.3f} | {check:.2f} | {check / call:.0f} |")
    return "\n".join(lines)


def python_calls(results):
    """Returns a row for each call: of C++, of Python, and their ratio."""
    study = load(results / "python.json")
    many, few = study["calls"], study["calls with 10,000 boxes"]
    rows = [("`find_pairs`, short form", many["short form"]), ("`find_pairs`, kept engine", many["kept engine"]),
            ("step with 1% moved, ids by a mask", study["step with 1% moved"]), ("10,000 boxes, short form", few["short form"]),
            ("10,000 boxes, kept engine", few["kept engine"])]
    lines = [f"| {study['objects']:,} boxes, {load(results / 'python.json')['measured']['cores']} threads, ms | C++ | Python | |",
             "|---|--:|--:|--:|"]
    lines += [f"| {name} | {milliseconds(row['cpp'])} | {milliseconds(row['python'])} | {row['python'] / row['cpp']:.2f} x |"
              for name, row in rows]
    return "\n".join(lines)


def python_scipy(results):
    """Returns a row for SciPy and for octopair: the same pairs of equal cubes."""
    study = load(results / "python.json")
    scipy = study["SciPy"]
    return "\n".join([
        f"| {study['objects']:,} equal cubes, {scipy['pairs']:,} pairs, one thread | seconds | |", "|---|--:|--:|",
        f"| `octopair.Engine(threads=1).find_pairs` | {scipy['octopair']:.3f} | |",
        f"| `scipy.spatial.cKDTree(...).query_pairs(r, p=inf, output_type=\"ndarray\")` | {scipy['scipy']:.2f} | "
        f"{factor(scipy['scipy'], scipy['octopair'])} |"])


def viewer(results):
    """Returns a row for each number of boxes: the first picture of the page."""
    lines = ["| boxes | first picture, s | MB sent | memory of the tab, MB |", "|--:|--:|--:|--:|"]
    for row in load(results / "viewer.json")["rows"]:
        lines.append(f"| {row['boxes']:,} | {row['milliseconds'] / 1e3:.1f} | {row['megabytes_sent']:.1f} | "
                     f"{row['megabytes_of_tab']:.0f} |")
    return "\n".join(lines)


BLOCKS = {
    "origin": origin_sentence, "same_call": same_call, "peers_short": peers_short, "small_worlds": small_worlds,
    "peers_summary": peers_summary, "frames_summary": frames_summary, "short": short, "paper": text_of("paper"),
    "machines": text_of("machines"), "scenes": text_of("scenes"), "frames": frames, "frame_queries": frame_queries,
    "frame_memory": frame_memory, "engines": engines, "engine_memory": engine_memory, "engine_choice": engine_choice,
    "service": service, "service_crowds": service_crowds, "exact_objects": exact_objects, "self_intersections": self_intersections,
    "scaling": scaling, "cluster": cluster, "models": models, "meshes": meshes, "large": large, "verification": verification,
    "python_calls": python_calls, "python_scipy": python_scipy, "viewer": viewer, "viewer_pace": text_of("viewer_pace"),
    **{f"adapter_{host}": text_of(f"adapter_{host}") for host in ("bullet", "cgal", "fcl")},
    **{name: model(name) for name in ("model", "model_check", "model_far")},
    **{f"peers_{table}": lambda results, table=table: peers(results, table)
       for table in ("1m_1", "1m_2", "100k_1", "100k_2", "10k_1", "real_1")},
}

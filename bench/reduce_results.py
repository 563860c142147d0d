#!/usr/bin/env python3
"""Reduces measurements to what the pages and their pictures show, with one record per line.

    bench/reduce_results.py [--check] FILE...

Each FILE is the JSON of a program of bench/, with the name that bench/results gives it. The file is rewritten. A reduced file stays
the same. With --check no file is written; the exit status is 1 if a file is not reduced.

Single measurements, of which only medians are shown, are removed. A run of `octopair-bench cluster` gets sums and largest values of
its ranks in place of a record per rank.
"""
import json
import pathlib
import sys

# Removed keys, by the begin of a file's name. Keys of other files stay.
REMOVED = {
    "engines": {"seconds"},
    "frames": {"case", "first_seconds", "processor_seconds", "seconds"},
    "paper": {"level", "seconds"},
    "peers": {"first_seconds", "hash", "seconds"},
    "scaling": {"seconds"},
    "self_intersections": {"seconds"},
}


def computing(rank):
    """Returns the processor seconds of a rank without those within MPI."""
    return sum(seconds for step, seconds in rank["cpu_seconds"].items() if step != "mpi")


def reduced_run(run):
    """Returns a run of `octopair-bench cluster` without the records of its ranks."""
    if "alone" not in run:
        return run
    alone, together = run["alone"], run["together"]
    reduced = {name: value for name, value in run.items() if name not in ("alone", "together")}
    reduced["cpu_seconds"] = {step: sum(rank["cpu_seconds"][step] for rank in alone) for step in alone[0]["cpu_seconds"]}
    reduced["computing_seconds"] = sum(map(computing, alone))
    reduced["slowest_seconds"] = max(map(computing, alone))
    reduced["octants"] = sum(rank["octants"] for rank in alone)
    reduced["most_octants"] = max(rank["octants"] for rank in alone)
    for name in ("bytes_sent", "messages_sent", "shared_objects"):
        reduced[name] = sum(rank[name] for rank in together)
    return reduced


def without(value, names):
    """Returns a copy of `value` without the keys in `names`, at every depth."""
    if isinstance(value, dict):
        return {name: without(part, names) for name, part in value.items() if name not in names}
    return [without(part, names) for part in value] if isinstance(value, list) else value


def has_records(value):
    """Returns whether `value` contains a list of objects, or of lines of text."""
    if isinstance(value, dict):
        return any(map(has_records, value.values()))
    return isinstance(value, list) and any(isinstance(part, (dict, str)) for part in value)


def text_of(value, indent=""):
    """Returns JSON with sorted keys, and with one line for each record: an inner object that contains no list of objects or lines."""
    if indent and not has_records(value):
        return json.dumps(value, sort_keys=True, ensure_ascii=False)
    inner = indent + " "
    if isinstance(value, dict):
        # The records come after the other keys, so that the head of a file says what was measured.
        keys = sorted(value, key=lambda name: (has_records(value[name]), name))
        parts, (begin, end) = [f"{json.dumps(name)}: {text_of(value[name], inner)}" for name in keys], "{}"
    else:
        parts, (begin, end) = [text_of(part, inner) for part in value], "[]"
    return begin + "\n" + ",\n".join(inner + part for part in parts) + "\n" + indent + end


def reduced_text(name, results):
    """Returns the text of the file `name` for the results of a program."""
    for begin, names in REMOVED.items():
        if name.startswith(begin):
            results = without(results, names)
    if name.startswith("cluster"):
        results = {**results, "runs": [reduced_run(run) for run in results["runs"]]}
    return text_of(results) + "\n"


def main(words):
    check = words[:1] == ["--check"]
    paths = [pathlib.Path(word) for word in words[check:]]
    if not paths:
        sys.exit("reduce_results.py [--check] FILE...")
    wrong = 0
    for path in paths:
        before = path.read_text(encoding="utf-8")
        after = reduced_text(path.name, json.loads(before))
        if check and after != before:
            print(f"{path}: the file is not reduced: run bench/reduce_results.py {path}", file=sys.stderr)
            wrong = 1
        elif after != before:
            path.write_text(after, encoding="utf-8")
    return wrong


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

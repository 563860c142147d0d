#!/usr/bin/python3
"""Measures how much hostile clients slow down others, and what memory they take.

    load.py --program PATH [--json FILE] [--seconds S] [--after S] [--only NAME...]

Fairness: the latency of 20 polite clients in three cases: alone; while a greedy client uses another server of the machine (the
control); while a greedy client uses the same server (attacked).
Hostile connections: the latency of one client with a token in three cases: alone; while 12 hostile connections go to a port that
ignores them (the control); while they go to the server (attacked).
The memory is the server's resident memory: before the attack, the most during the attack, and some time after the attack.
"""
import json
import pathlib
import time

import greedy
import hostile
import polite
import settings
from boxes import equal_boxes
from client import Client, new_id
from server import TOKENS, MemoryWatch, Server
from sink import Sink

CONNECTIONS = 12
POLITE_CLIENTS, POLITE_PAUSE = 20, 0.05
SINGLE_PAUSE = 0.02
NICE = 10  # niceness of attackers: a busy attacker must not take the CPU from the server
START_SECONDS = 0.3  # from the start of an attack to the measurement, which shows the start of the attack, too

STRANGERS = ["silent", "garbage", "client hello", "slow header", "rapid reset", "ping flood", "settings flood", "tokenless calls",
             "health watch", *(f"endless header, {kind}" for kind in hostile.ENDLESS_HEADERS)]
CLIENTS = ["unread results", "half uploads", *hostile.RESET_CALLS, "ping flood", "settings flood",
           *(f"endless header, {kind}" for kind in hostile.ENDLESS_HEADERS)]
ATTACKS = [(kind, None) for kind in STRANGERS] + [(kind, "greedy") for kind in CLIENTS]


def name_of(kind, token):
    """Returns the name of an attack in the table."""
    return kind + (", with a token" if token else "")


def quantile(values, part):
    """Returns a quantile of sorted values."""
    return values[min(len(values) - 1, int(part * len(values)))]


def summary(measured):
    """Returns p50, p99 and the most of (milliseconds, errors) of polite.run, with the number of calls and the errors."""
    times, errors = measured
    return {"p50": quantile(times, 0.5), "p99": quantile(times, 0.99), "most": times[-1], "calls": len(times),
            "errors": len(errors), "error": errors[0] if errors else ""}


def ratios(result, control, attacked):
    """Adds the ratios of the medians and of the p99 to a result."""
    for part in ("p50", "p99"):
        result[f"{part} ratio"] = result[attacked][part] / result["alone"][part]
        result[f"{part} ratio to control"] = result[attacked][part] / result[control][part]
    return result


def end(process):
    """Ends a process of an attack."""
    process.kill()
    process.wait()


def measure_fairness(seconds):
    """Measures the polite clients alone and with greedy clients. Returns the result."""
    result = {"name": "20 polite clients and a greedy one"}
    with Server() as server, Server() as other:
        def measured():
            return summary(polite.run(server.address, POLITE_CLIENTS, seconds, POLITE_PAUSE))
        result["alone"] = measured()
        for label, target in (("control", other), ("attacked", server)):
            before = server.resident_bytes()
            process = greedy.start(target.address, NICE)
            time.sleep(START_SECONDS)
            with MemoryWatch(server) as watch:
                result[label] = measured()
            end(process)
            result["before"], result["during"] = before, watch.most
        time.sleep(5)
        result["after"] = server.resident_bytes()
    return ratios(result, "control", "attacked")


def make_large_result(server):
    """Runs a job of the greedy client with 36 MB of pairs. Returns its id."""
    job_id = new_id()
    with Client(server, "greedy") as client:
        client.submit(equal_boxes(3000), job_id)
        client.wait(job_id)
    return job_id


def measure_attack(kind, token, seconds, after):
    """Measures one client alone and with hostile connections of a kind. Returns the result."""
    result = {"name": name_of(kind, token)}
    with Server() as server, Sink(answers=kind == "tokenless calls") as sink:
        job_id = make_large_result(server) if kind == "unread results" else None

        def measured():
            return summary(polite.run(server.address, 1, seconds, SINGLE_PAUSE))
        polite.run(server.address, 1, 0.2, SINGLE_PAUSE)  # the first calls of a server take longer
        result["alone"], result["before"] = measured(), server.resident_bytes()
        for label, address in (("control", sink.address), ("attacked", server.address)):
            with MemoryWatch(server) as watch:
                process = hostile.start(kind, address, seconds + 2, CONNECTIONS, TOKENS.get(token), job_id, NICE)
                time.sleep(START_SECONDS)
                result[label] = measured()
                end(process)
        result["during"] = watch.most
        time.sleep(after)
        result["after"], result["lives"] = server.resident_bytes() if server.lives() else 0, server.lives()
    return ratios(result, "control", "attacked")


COLUMNS = (f"{'':41} {'alone':>13} {'control':>13} {'attacked':>21} {'ratio':>12} {'to control':>12} {'memory, MiB':>14} "
           f"{'errors':>6}")


def row_of(result):
    """Returns a line of the table: p50/p99/most of each measurement, ratios of p50/p99, and memory before/during/after."""
    def times(label, *parts):
        return "/".join(f"{result[label][part]:.1f}" for part in parts)

    def ratio(ending):
        return f"{result['p50 ratio' + ending]:.1f}/{result['p99 ratio' + ending]:.1f}"
    memory = "/".join(str(result[part] >> 20) for part in ("before", "during", "after"))
    return (f"{result['name']:41} {times('alone', 'p50', 'p99'):>13} {times('control', 'p50', 'p99'):>13} "
            f"{times('attacked', 'p50', 'p99', 'most'):>21} {ratio(''):>12} {ratio(' to control'):>12} {memory:>14} "
            f"{result['attacked']['errors']:>6}")


def main():
    """Runs the command line."""
    parser = settings.parser(__doc__)
    parser.add_argument("--json", metavar="FILE", help="write all results to this file")
    parser.add_argument("--seconds", type=float, default=4.0, help="duration of a measurement")
    parser.add_argument("--after", type=float, default=15.0, help="time from an attack to the last measurement of memory")
    parser.add_argument("--only", nargs="*", help="'fairness', or names of the attacks to measure")
    options, _ = settings.parse(parser)
    results = []

    def add(name, measure, *arguments):
        if options.only is None or name in options.only:
            results.append(measure(*arguments))
            print(row_of(results[-1]), flush=True)
            if options.json:
                pathlib.Path(options.json).write_text(json.dumps(results, indent=1), encoding="utf-8")

    print("Milliseconds: p50/p99, or p50/p99/most. Memory: before/during/after.\n" + COLUMNS)
    add("fairness", measure_fairness, 3 * options.seconds)
    for kind, token in ATTACKS:
        add(name_of(kind, token), measure_attack, kind, token, options.seconds, options.after)


if __name__ == "__main__":
    main()

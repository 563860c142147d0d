#!/usr/bin/env bash
# Tests that `octopair-bench scaling` measures threads and ranks, and leaves no file if it fails.
#
#     scaling.sh PROGRAM MPIRUN
source "$(dirname "$(realpath "$0")")/../mpi/in_folder.sh"
scaling() { "$program" scaling --mpirun "$mpirun" --rounds 3 "$@"; }

scaling --scene uniform dense --objects 4000 --cores 2 3 --threads-per-rank 2 --json strong.json > table.txt
scaling --objects 2000 --weak --cores 2 4 --json weak.json >> table.txt
grep -q '^dense, 4000 objects, 3 rounds$' table.txt || fail "no table of a scene: $(cat table.txt)"
grep -q '^uniform, 2000 objects a core, 3 rounds$' table.txt || fail "no table of weak scaling: $(cat table.txt)"
[ "$(grep -cE '^  3 ranks +3 +4000 +[0-9]+( +[0-9.]+){2} +[0-9.]+% +[0-9.]+$' table.txt)" = 2 ] ||
    fail "no row of three ranks: $(cat table.txt)"
[ "$(grep -cE '^  1 rank +1 +[24]000 +[0-9]+( +[0-9.]+){2} +[0-9.]+% +[0-9.]+$' table.txt)" = 3 ] ||
    fail "no rows of one rank beside one thread: $(cat table.txt)"
python3 - << 'END'
import json
from statistics import median

def results(name):
    return json.load(open(name))["results"]

for result in results("strong.json") + results("weak.json"):
    rows = {(row["ranks"], row["threads"]): row for row in result["rows"]}
    if result["weak"]:
        assert list(rows) == [(0, 1), (0, 2), (0, 4), (1, 1), (2, 1), (4, 1)], list(rows)
    else:
        assert list(rows) == [(0, 1), (0, 2), (0, 3), (1, 1), (2, 1), (3, 1), (1, 2)], list(rows)
    for (ranks, threads), row in rows.items():
        cores = max(ranks, 1) * threads
        assert row["cores"] == cores and row["engine"] == ("mpi" if ranks else "local")
        assert row["objects"] == result["objects"] * (cores if result["weak"] else 1)
        assert row["pairs"] == rows[0, cores]["pairs"] > 0
        assert len(row["seconds"]) == 3 and row["median_seconds"] == median(row["seconds"]) > 0
        speedup = rows[0, 1]["median_seconds"] / row["median_seconds"] * row["objects"] / rows[0, 1]["objects"]
        assert abs(row["speedup"] / speedup - 1) < 1e-9 and abs(row["efficiency"] * cores / speedup - 1) < 1e-9
        if ranks:
            assert abs(row["against_threads"] * rows[0, cores]["median_seconds"] / row["median_seconds"] - 1) < 1e-9
END

# Calls that fail: without an mpirun, and with fewer ranks than cores.
status=0
"$program" scaling --cores 2 --mpirun no-such-mpirun --json no.json > /dev/null 2> errors.txt || status=$?
[ "$status" = 6 ] || fail "exit status $status without an mpirun"
grep -q 'cannot run no-such-mpirun' errors.txt || fail "no message about mpirun: $(cat errors.txt)"
status=0
"$mpirun" -n 1 "$program" scaling --cores 2 --on-ranks no.json 2> errors.txt || status=$?
[ "$status" = 2 ] || fail "exit status $status with too few ranks: $(cat errors.txt)"
[ ! -e no.json ] || fail "a failed call left a file"
echo "threads and ranks are measured"

#!/usr/bin/env bash
# `octopair bench cluster` measures ranks, and leaves nothing where it cannot.
#
#     bench.sh PROGRAM MPIRUN
set -euo pipefail
program=$1 mpirun=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() { echo "$*" && exit 1; }

"$program" bench cluster --scene uniform dense --objects 3000 --ranks 1 3 --rounds 2 --mpirun "$mpirun" --json all.json > table.txt
grep -q '^3000 objects, dense: [1-9][0-9]* pairs$' table.txt || fail "no table of a scene: $(cat table.txt)"
[ "$(grep -cE '^ +3( +[0-9.]+){3} +[0-9.]+% ' table.txt)" = 2 ] || fail "no row of three ranks: $(cat table.txt)"
python3 - << 'END'
import json
runs = json.load(open("all.json"))["runs"]
assert [(run["ranks"], run["scene"]) for run in runs] == [(1, "uniform"), (1, "dense"), (3, "uniform"), (3, "dense")]
for run in runs:
    costs = run["costs"]
    assert len(costs) == run["ranks"] and sum(rank["objects"] for rank in costs) == 3000
    # Each object is received by one rank, or by several that share it.
    received, shared = (sum(rank[name] for rank in costs) for name in ("objects_received", "shared_objects"))
    assert run["ranks"] == 1 or received >= 3000 + shared
    assert all(rank["cpu_seconds"]["scan"] > 0 for rank in costs)
assert {run["pairs"] for run in runs if run["scene"] == "dense"} == {runs[1]["pairs"]}
END

status=0
"$program" bench cluster --ranks 2 --mpirun "no-such-mpirun" --json no.json > /dev/null 2> errors.txt || status=$?
[ "$status" = 6 ] || fail "exit status $status without an mpirun"
grep -q 'cannot run no-such-mpirun' errors.txt || fail "not said: $(cat errors.txt)"
status=0
"$program" bench cluster --ranks 2 --mpirun "$mpirun --no-such-option" --json no.json > /dev/null 2>&1 || status=$?
[ "$status" = 6 ] || fail "exit status $status where mpirun fails"
[ ! -e no.json ] || fail "a file is left by what failed"
echo "ranks are measured"

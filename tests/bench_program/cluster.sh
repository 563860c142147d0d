#!/usr/bin/env bash
# Tests that `octopair-bench cluster` measures ranks, and leaves no file if it fails.
#
#     cluster.sh PROGRAM MPIRUN
source "$(dirname "$(realpath "$0")")/../mpi/in_folder.sh"

"$program" cluster --scene uniform dense --objects 3000 --ranks 1 3 --rounds 2 --mpirun "$mpirun" --json all.json > table.txt
grep -q '^3000 objects, dense: [1-9][0-9]* pairs$' table.txt || fail "no table of a scene: $(cat table.txt)"
[ "$(grep -cE '^ +3( +[0-9.]+){3} +[0-9.]+% ' table.txt)" = 2 ] || fail "no row of three ranks: $(cat table.txt)"
python3 - << 'END'
import json
runs = json.load(open("all.json"))["runs"]
assert [(run["ranks"], run["scene"]) for run in runs] == [(1, "uniform"), (1, "dense"), (3, "uniform"), (3, "dense")]
for run in runs:
    costs = run["together"]
    assert len(costs) == run["ranks"] and sum(rank["objects"] for rank in costs) == 3000
    # One rank receives each object, or several ranks that share the object.
    received, shared = (sum(rank[name] for rank in costs) for name in ("objects_received", "shared_objects"))
    assert run["ranks"] == 1 or received >= 3000 + shared
    assert all(rank["cpu_seconds"]["scan"] > 0 for rank in costs)
assert {run["pairs"] for run in runs if run["scene"] == "dense"} == {runs[1]["pairs"]}
END

# The paper's algorithm: one rank has all objects at first, and scans alone; the first rank of each machine merges.
"$program" cluster --objects 3000 --ranks 1 4 --rounds 1 --arrangement shared paper --mpirun "$mpirun" --json all.json --quiet > table.txt
grep -q '^3000 objects, uniform: [1-9][0-9]* pairs, arranged as in the paper, 2 to a machine$' table.txt || fail "$(cat table.txt)"
"$program" paper --machines 1 2 --objects 3000 --rounds 1 --latency 5 --mpirun "$mpirun" --json paper.json --quiet > table.txt
grep -q '^Run time in microseconds, uniform, 3,000 objects, 2 processors on each machine$' table.txt || fail "$(cat table.txt)"
python3 - << 'END'
import json
runs = json.load(open("all.json"))["runs"]
assert [(run["ranks"], run["arrangement"]) for run in runs] == [(1, "shared"), (1, "paper"), (4, "shared"), (4, "paper")]
assert len({run["pairs"] for run in runs}) == 1 and len({(run["arrangement"], run["entries"]) for run in runs}) == 2
shared, paper = ([rank["cpu_seconds"] for rank in run["alone"]] for run in runs[2:])
assert all(rank["merge"] == 0 and rank["scan"] > 0 for rank in shared)
assert [rank["scan"] > 0 for rank in paper] == [True, False, False, False]
assert all(rank["build"] > 0 for rank in paper) and paper[0]["merge"] > 0 and paper[2]["merge"] > 0
assert [rank["objects"] for rank in runs[3]["together"]] == [3000, 0, 0, 0]
paper = json.load(open("paper.json"))
assert paper["network_model"] == {"latency_seconds": 5e-6, "bytes_per_second": 1e8}
modelled = {(row["ranks"], row["arrangement"]): row["network_seconds"] for row in paper["runs"]}
assert set(modelled) == {(ranks, arrangement) for ranks in (1, 2, 4) for arrangement in ("shared", "paper")}
# One machine needs no network. With two machines, the master's network carries at least half of objects and entries.
assert all((seconds > 0) == (ranks == 4) for (ranks, _), seconds in modelled.items())
assert modelled[4, "paper"] > (3000 / 2 * 24 + 3000 / 2 * 16) / 1e8
END

status=0
"$program" cluster --ranks 2 --mpirun "no-such-mpirun" --json no.json > /dev/null 2> errors.txt || status=$?
[ "$status" = 6 ] || fail "exit status $status without an mpirun"
grep -q 'cannot run no-such-mpirun' errors.txt || fail "no message about mpirun: $(cat errors.txt)"
status=0
"$program" cluster --ranks 2 --mpirun "$mpirun --no-such-option" --json no.json > /dev/null 2>&1 || status=$?
[ "$status" = 6 ] || fail "exit status $status where mpirun fails"
[ ! -e no.json ] || fail "a failed call left a file"
echo "ranks are measured"

#!/usr/bin/env bash
# Tests that `octopair detect --engine mpi` writes the files of the local engine, and ends in the same way on all ranks.
#
#     detect.sh PROGRAM MPIRUN
source "$(dirname "$(realpath "$0")")/in_folder.sh"

"$program" generate clustered --objects 20000 --seed 3 --output a.npy --quiet
"$program" generate micro20 --objects 3000 --seed 3 --output b.npy --quiet
"$program" generate brownian --objects 2000 --frames 3 --seed 1 --output moving.npy --quiet
printf '0,0,0,1,1,1\n5,5,5,6,6,6\n1,0,0,2,1,1\n' > few.csv
python3 - << 'END'
# Paddings of 20,000 + 3,000 objects, and 1,000 spheres; written without NumPy, which may not be installed.
import array, struct
def write(name, code, shape, values):
    text = "{'descr': '%s', 'fortran_order': False, 'shape': %s, }" % (code, shape)
    text += " " * (63 - (10 + len(text)) % 64) + "\n"
    with open(name, "wb") as f:
        f.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode() + values.tobytes())
write("padding.npy", "<f8", "(23000,)", array.array("d", [0.001 * (i % 7) for i in range(23000)]))
write("spheres.npy", "<f4", "(1000, 4)", array.array("f", [(i * 37 % 101) * 0.01 for i in range(4000)]))
END

for order in ascending octal; do
    on_ranks 3 detect a.npy b.npy --order $order --engine mpi --index-type uint64 --output wide.npy --quiet
    "$program" detect a.npy b.npy --order $order --output narrow.npy --quiet
    python3 - << 'END'
import array
wide, narrow = (open(name, "rb").read() for name in ("wide.npy", "narrow.npy"))
assert b"'<u8'" in wide[:128] and wide[128:]
assert list(array.array("Q", wide[128:])) == list(array.array("I", narrow[128:]))
END
    same 3 pairs.npy a.npy b.npy --order $order --padding padding.npy
    same 4 pairs.csv a.npy --against b.npy --order $order --margin 0.002
    same 2 pairs.jsonl a.npy few.csv spheres.npy --order $order --limit 5000
done
same 5 few.npy few.csv
same 3 pairs.csv moving.npy
same 3 frames.npy few.csv
for frame in 0 1 2; do rm -f "local.$frame.npy" "ranks.$frame.npy"; done
"$program" detect moving.npy --output local.moving.npy --quiet
on_ranks 2 detect moving.npy --engine mpi --threads 2 --output ranks.moving.npy --quiet
for frame in 000000 000001 000002; do cmp "local.moving.$frame.npy" "ranks.moving.$frame.npy"; done
[ "$("$program" detect a.npy --count-only --quiet)" = "$(on_ranks 3 detect a.npy --engine mpi --count-only --quiet)" ] ||
    fail "ranks give another count"
[ "$("$program" detect few.csv --quiet)" = "$(on_ranks 2 detect few.csv --engine mpi --quiet)" ] || fail "other pairs"
on_ranks 2 detect a.npy --engine mpi --stats stats.json --count-only 2> summary.txt > count.txt
grep -q '"ranks": 2' stats.json || fail "the stats do not have the number of ranks"
grep -q 'on 2 ranks with 1 thread each' summary.txt || fail "the summary does not have the number of ranks"

for order in "--order ascending" "--order octal" "--count-only" "--limit 1000" "--against b.npy"; do
    on_ranks 3 detect a.npy --engine mpi --verify --stats stats.json $order > pairs.csv 2> summary.txt
    grep -q '"verified": true' stats.json || fail "the stats do not say that the pairs were verified: $order"
    grep -q '^verified    .* by a second algorithm' summary.txt || fail "no verification in the summary: $order"
done

same 3 events.csv moving.npy --events
same 2 events.jsonl moving.npy --events --margin 0.01 --limit 2000
same 3 events.csv moving.npy --against few.csv --events
on_ranks 3 detect moving.npy --engine mpi --events --stats stats.json --output events.csv 2> summary.txt
grep -q 'on 3 ranks with 1 thread each' summary.txt || fail "the summary of events does not have the number of ranks"

printf '0,0,0,1,1,1\n5,5,5,6,6,6\n1,0,0,2,1,nan\n' > bad.csv
refuses 3 'bad.csv: .*' bad.csv
refuses 4 'missing.npy' missing.npy
for input in bad.csv missing.npy; do
    status=0
    on_ranks 3 detect $input --engine mpi --events --output events.csv --quiet 2> errors.txt || status=$?
    [ "$status" = "$([ $input = bad.csv ] && echo 3 || echo 4)" ] || fail "exit status $status for events of $input"
    [ "$(grep -c "octopair: .*$input" errors.txt)" = 1 ] || fail "not printed once: $(cat errors.txt)"
done
refuses 3 'a.npy: 20000 paddings\|padding.npy: 23000 paddings' a.npy --padding padding.npy
status=0
on_ranks 2 detect a.npy --engine mpi --fail-on-collision --count-only --quiet > /dev/null 2>&1 || status=$?
[ "$status" = 1 ] || fail "exit status $status under --fail-on-collision"
status=0
on_ranks 2 detect a.npy --engine mpi --output /nowhere/pairs.npy --quiet 2> errors.txt || status=$?
[ "$status" = 4 ] || fail "exit status $status for an output in a folder that does not exist"

# If a rank is killed, all ranks end within 10 seconds.
"$program" generate coincident --objects 400000 --seed 1 --output much.npy --quiet
on_ranks 3 detect much.npy --engine mpi --count-only --quiet > /dev/null 2>&1 &
job=$!
ranks_at_work() { pgrep -f "^$program detect much.npy" || true; }
for _ in $(seq 200); do [ "$(ranks_at_work | wc -l)" -ge 3 ] && break || sleep 0.05; done
sleep 0.3
kill -9 "$(ranks_at_work | sed -n 2p)"
status=0
wait $job || status=$?
[ "$status" != 0 ] || fail "the call succeeded although a rank was killed"
for _ in $(seq 100); do [ -n "$(ranks_at_work)" ] || break; sleep 0.1; done
[ -z "$(ranks_at_work)" ] || fail "other ranks run after a rank was killed"
echo "ranks give what threads give"

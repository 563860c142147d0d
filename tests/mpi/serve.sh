#!/usr/bin/env bash
# Tests that `mpirun octopair serve --engine mpi` answers like every server, and that all ranks end if one rank fails.
#
#     serve.sh PROGRAM MPIRUN
set -euo pipefail
program=$1 mpirun=$2
work=$(mktemp -d)
server=""
# Kills the ranks, because mpirun removes their resources unless mpirun itself is killed.
clean_up() {
    [ -z "$server" ] || { { kill -KILL $(ranks) || kill "$server"; } && wait "$server"; } 2> /dev/null || true
    rm -rf "$work"
}
trap clean_up EXIT
cd "$work"
address=unix:$work/socket

fail() { echo "$*" && cat log && exit 1; }
ranks() { pgrep -f "^$program serve --listen $address" || true; }
# first_rank prints the process id of rank 0, which is in the log. rank NUMBER prints that of another rank (1 or 2).
first_rank() { sed -n 's/.* started .* ranks=3 pid=//p' log; }
rank() { ranks | grep -vx "$(first_rank)" | sed -n "$1p"; }
# ARGUMENTS...: starts a server on 3 ranks.
start() {
    : > log  # The command below empties the log late, maybe after the first grep. The log of an earlier server says "started", too.
    "$mpirun" -n 3 "$program" serve --listen "$address" --engine mpi --state state --max-memory 128M "$@" 2> log &
    server=$!
    for _ in $(seq 600); do grep -q ' started ' log && break || sleep 0.05; done
    grep -q ' started ' log || fail "the server did not start"
    segments=$(cat $(ranks | sed 's|.*|/proc/&/maps|') | grep -o '/dev/shm/[^ ]*' | sort -u || true)
}
# STATUS: fails unless mpirun ends with STATUS (or `any`), and neither ranks nor shared memory are left.
ended() {
    local status=0 segment
    wait "$server" || status=$?
    [ "$1" = any ] || [ "$status" = "$1" ] || fail "mpirun ends with $status, not $1"
    for _ in $(seq 100); do [ -n "$(ranks)" ] || break; sleep 0.05; done
    [ -z "$(ranks)" ] || fail "ranks are left"
    for segment in $segments; do [ ! -e "$segment" ] || fail "$segment is left"; done
    server=""
}
detect() { "$program" detect "$@" --quiet; }

"$program" generate clustered --objects 40000 --seed 3 --output a.npy --quiet
"$program" generate micro20 --objects 30000 --seed 3 --output b.npy --quiet
"$program" generate coincident --objects 400000 --seed 1 --output much.npy --quiet
"$program" generate brownian --objects 30000 --frames 2 --seed 1 --output moving.npy --quiet
printf '0,0,0,1,1,1\n5,5,5,6,6,6\n1,0,0,2,1,1\n' > few.csv
python3 - << 'END'
# 40,000 paddings, and 25,000 boxes in float64, without and with an invalid box; written without NumPy, which may not be
# installed.
import array, struct
def write(name, shape, values):
    text = "{'descr': '<f8', 'fortran_order': False, 'shape': %s, }" % shape
    text += " " * (63 - (10 + len(text)) % 64) + "\n"
    with open(name, "wb") as f:
        f.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode() + array.array("d", values).tobytes())
write("padding.npy", "(40000,)", [0.0001 * (i % 7) for i in range(40000)])
boxes = [low + size for i in range(25000) for size in (0, 0.02) for low in [(i * k % 1009) / 1009 for k in (7, 31, 101)]]
write("wide.npy", "(25000, 6)", boxes)
boxes[6 * 20000] = float("nan")
write("bad.npy", "(25000, 6)", boxes)
END

# NAME ARGUMENTS...: fails unless the server gives the same file, or the same error message, as threads.
same() {
    local name=$1 status=0 server_status=0
    shift
    detect "$@" --output "local.$name" 2> local.txt || status=$?
    detect "$@" --engine "$address" --output "ranks.$name" 2> ranks.txt || server_status=$?
    [ "$status" = "$server_status" ] || fail "exit status $server_status, not $status, for: $*"
    cmp local.txt ranks.txt || fail "the server gives another message for: $*"
    [ "$status" != 0 ] || cmp "local.$name" "ranks.$name" || fail "the ranks give another $name for: $*"
}

start
clients=()
(for order in ascending octal; do same "first.$order.npy" a.npy --against b.npy --order $order --margin 0.01; done) &
clients+=($!)
(cd "$(mktemp -d -p "$work")" && ln -s ../*.npy . && same pairs.csv a.npy --padding padding.npy --order octal &&
    same pairs.npy wide.npy --limit 3000 && same pairs.npy bad.npy) &
clients+=($!)
for client in "${clients[@]}"; do wait "$client" || fail "a client got another result"; done
same few.npy few.csv
same pairs.csv moving.npy
[ "$(detect a.npy --count-only)" = "$(detect a.npy --count-only --engine "$address")" ] || fail "ranks count other pairs"

# A rank that waits for a call sleeps.
ticks() { cut -d ' ' -f 14,15 "/proc/$(rank 1)/stat" | tr ' ' + | { read -r sum && echo $((sum)); }; }
sleep 0.3
before=$(ticks)
sleep 1
spent=$((100 * ($(ticks) - before) / $(getconf CLK_TCK)))
[ "$spent" -le 30 ] || fail "a rank without work takes $spent % of a core"

# If a client ends, its job ends on all ranks.
"$program" detect much.npy --count-only --engine "$address" --quiet > /dev/null 2>&1 &
client=$!
for _ in $(seq 1000); do  # until the client has blocked SIGINT, to handle it as a request to stop
    ! grep -q '^SigBlk:.*[2367abef]$' /proc/$client/status || break
    sleep 0.01
done
sleep 0.7
kill -INT $client
status=0
wait $client || status=$?
[ "$status" = 130 ] || fail "an interrupted client ends with $status"
same pairs.npy a.npy

# If a rank is killed, the server ends. The next server does the unfinished jobs.
kill -STOP "$(rank 2)"  # so that the jobs do not finish
id=$("$program" submit a.npy --server "$address" --quiet)
detect a.npy --engine "$address" --output again.npy &
client=$!
detect a.npy --engine "$address" --patience 0.5 --output no.npy 2> errors.txt &
hasty=$!
sleep 0.5
kill -KILL "$(rank 2)"
ended any
status=0
wait $hasty || status=$?
[ "$status" = 6 ] || fail "a client without a server ends with $status"
grep -q 'no server answers' errors.txt || fail "the client printed: $(cat errors.txt)"
[ ! -e no.npy ] || fail "a client without a server leaves a file"
start
wait $client || fail "a client does not find the next server"
cmp local.pairs.npy again.npy || fail "the next server gives another result"
"$program" result "$id" --server "$address" --output detached.npy --release --quiet
cmp local.pairs.npy detached.npy || fail "a detached job gives another result"

# SIGTERM at rank 0 ends the server, after the running jobs. SIGTERM at another rank has no effect.
kill -TERM "$(rank 1)"
detect a.npy --engine "$address" --output last.npy
cmp local.pairs.npy last.npy || fail "a signal at another rank changes the result"
kill -TERM "$(first_rank)"
ended 0
grep -q ' stopped' log || fail "the server did not stop in order"

# If a rank is stopped, the job's client gets an error, and the server ends.
start --rank-timeout 1
kill -STOP "$(rank 1)"
status=0
timeout 20 "$program" detect a.npy --engine "$address" --output no.npy --quiet 2> errors.txt || status=$?
[ "$status" = 6 ] || fail "a client of stopped ranks ends with $status"
grep -q 'rank [12] has not answered for 1 s' errors.txt || fail "the client printed: $(cat errors.txt)"
ended 6

# If rank 0 cannot serve, all ranks end, and only rank 0 prints a message.
status=0
"$mpirun" -n 3 "$program" serve --listen 0.0.0.0:0 --engine mpi 2> errors.txt || status=$?
[ "$status" = 2 ] || fail "exit status $status for an address that rank 0 refuses"
[ "$(grep -c 'octopair: ' errors.txt)" = 1 ] || fail "the message was not printed once: $(cat errors.txt)"
echo "ranks serve"

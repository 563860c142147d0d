#!/usr/bin/env bash
# Tests `octopair detect --engine mpi` on separate hosts. The bytes equal those of the local engine, also over a slow
# network. If a link is cut, the call ends in time.
#
#     hosts.sh PROGRAM MPIRUN
#
# The hosts alpha, beta and gamma are Linux namespaces. Each host has its own network, name, processes, shared memory
# and folder for temporary files, so ranks on different hosts share only the network. The hosts are inside namespaces of
# this script, and end when the script ends for any reason. If the system permits no namespaces, the script exits with 77.
set -euo pipefail
program=$1 mpirun=$2
here=$(cd "${0%/*}" && pwd)

fail() { echo "$*" && exit 1; }
skip() { echo "skipped: $*" && exit 77; }

if [ -z "${OCTOPAIR_HOSTS:-}" ]; then
    for tool in unshare nsenter ip python3; do
        [ -n "$(command -v $tool)" ] || skip "$tool is not installed"
    done
    apart=(unshare --net --uts --ipc --mount --pid --fork --kill-child --mount-proc)
    [ "$(id -u)" = 0 ] || apart+=(--user --map-root-user)
    reason=$("${apart[@]}" ip link add name a type veth peer name b 2>&1) || skip "no right to make namespaces: $reason"
    OCTOPAIR_HOSTS=$(mktemp -d)
    export OCTOPAIR_HOSTS
    trap '[ -z "${within:-}" ] || kill -KILL $within; rm -rf "$OCTOPAIR_HOSTS"' EXIT
    "${apart[@]}" "$0" "$@" &
    within=$!
    status=0
    wait $within || status=$?
    within=
    exit $status
fi

# The rest of the script runs on host alpha, like mpirun.
work=$OCTOPAIR_HOSTS
cd "$work"
hosts=(alpha beta gamma)
export TMPDIR=$work/tmp    # files through which Open MPI's daemons and ranks of one host communicate
mkdir tmp

# WHERE COMMAND...: runs a command in the network of a host, or of the wire.
in_network() { nsenter --target "$(cat "$1")" --net "${@:2}"; }
wait_for() { until [ -e "$1" ]; do sleep 0.01; done; }

# NAME: sets up a host: its name, loopback interface, temporary files, shared memory and addresses.
settle() {
    hostname "$1"
    ip link set lo up
    mount -t tmpfs tmpfs "$TMPDIR"
    mount -t tmpfs tmpfs /dev/shm
    mount --bind "$OCTOPAIR_HOSTS/addresses" /etc/hosts
}
export -f settle

make_hosts() {
    local host number=0
    unshare --net sh -c 'touch wire.up; exec sleep infinity' &
    echo $! > wire
    wait_for wire.up
    in_network wire ip link add name bridge up type bridge
    for host in "${hosts[@]}"; do
        number=$((number + 1))
        echo "10.77.0.$number $host" >> addresses
        echo "$host slots=8" >> hostfile
    done
    settle alpha
    echo $$ > alpha
    for host in beta gamma; do
        unshare --net --uts --ipc --mount --pid --fork --kill-child --mount-proc \
            bash -c "settle $host; touch $host.up; sleep infinity & wait" &
        wait_for $host.up
        pgrep -P $! > $host
    done
    number=0
    for host in "${hosts[@]}"; do
        number=$((number + 1))
        in_network $host ip link add name eth0 type veth peer name $host netns "$(cat wire)"
        in_network $host ip address add 10.77.0.$number/24 dev eth0
        in_network $host ip link set eth0 up
        in_network wire ip link set $host master bridge up
    done
}

# HOST COMMAND...: runs a command on a host. Open MPI starts its daemons with this script instead of ssh.
cat > as_ssh << 'END'
#!/bin/sh
host=$(cat "$OCTOPAIR_HOSTS/$1")
shift
exec nsenter --target "$host" --net --uts --ipc --mount --pid sh -c "$*"
END
chmod +x as_ssh

on_ranks() {
    "$mpirun" "${settings[@]}" --mca plm_rsh_agent "$work/as_ssh" --hostfile hostfile --map-by node -n "$1" "${@:2}"
}
settings=()

# MILLISECONDS MEGABITS: delays every frame by the milliseconds, and sends at most the megabits per second to each host.
slow_down() {
    local host
    for host in "${hosts[@]}"; do in_network wire ip link set $host nomaster; done
    [ -z "${slow:-}" ] || { kill $slow && wait $slow || true; }
    in_network wire "$here/slow_wire.py" "$@" "${hosts[@]}" &
    slow=$!
}

# HOST: prints the number of bytes that the host has received and sent.
carried() { in_network "$1" awk '$1 == "eth0:" { print $2 + $10 }' /proc/net/dev; }

# SCENE ORDER: fails unless ranks give the bytes of the local engine.
same() {
    "$program" detect "$1" --order "$2" --output local.npy --quiet
    on_ranks 5 "$program" detect "$1" --order "$2" --engine mpi --output ranks.npy --stats stats.json --quiet
    cmp local.npy ranks.npy || fail "hosts give other bytes: $1, $2"
}

at_work() { pgrep -f "^$program detect $1|^orted|^[^ ]*/orted" || true; }

# SCENE COMMAND...: runs a command, which cuts a link, while a call sends its objects. The call must fail. All its
# processes must end within 15 seconds after that.
cut_short() {
    local job status=0 before
    before=$(carried gamma)
    on_ranks 3 "$program" detect "$1" --engine mpi --output cut.npy --quiet > said.txt 2>&1 &
    job=$!
    until [ $(($(carried gamma) - before)) -gt 1000000 ]; do
        kill -0 $job || fail "the call ended before the cut: $(cat said.txt)"
        sleep 0.02
    done
    "${@:2}"
    SECONDS=0
    wait $job || status=$?
    [ $status != 0 ] || fail "the call succeeded after the cut"
    while [ -n "$(at_work "$1")" ]; do
        [ $SECONDS -lt 15 ] || fail "processes run after the cut: $(ps -o pid,args -p $(at_work "$1"))"
        sleep 0.1
    done
    [ ! -e cut.npy ] || fail "the call left a file after the cut"
    echo "exit status $status and no process left after $SECONDS s"
}

make_hosts
"$program" generate clustered --objects 100000 --seed 3 --output boxes.npy --quiet
"$program" generate uniform --objects 1000000 --seed 3 --output many.npy --quiet

[ "$(on_ranks 3 hostname | sort | xargs)" = "${hosts[*]}" ] || fail "not one rank on each host"
same boxes.npy octal
[ "$(carried gamma)" -gt 300000 ] || fail "no objects went through the network"
echo "hosts give the bytes of the local engine"

slow_down 5 100
same boxes.npy ascending
python3 -c 'import json; assert json.load(open("stats.json"))["seconds"]["detect"] > 0.1' || fail "the network is not slow"
echo "hosts give these bytes also with 5 ms and 100 Mbit/s between them"

# Cuts the link between two hosts that mpirun's host still reaches. Only a limit of the total time ends the call.
slow_down 1 10
lose_each_other() { in_network beta ip neighbour replace 10.77.0.3 dev eth0 lladdr 02:00:00:00:00:99 nud permanent; }
settings=(--timeout 8)
cut_short many.npy lose_each_other
in_network beta ip neighbour delete 10.77.0.3 dev eth0

# Cuts the links between gamma and all other hosts. The daemons detect this by TCP keepalive.
settings=(--mca oob_tcp_keepalive_time 1 --mca oob_tcp_keepalive_intvl 1 --mca oob_tcp_keepalive_probes 2)
cut_short many.npy in_network wire ip link set gamma down

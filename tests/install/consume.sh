#!/usr/bin/env bash
# Builds and runs consumers of octopair outside the tree.
#
#     consume.sh installed|subdirectory ROOT BUILD COMPILER PROGRAM PROCESSES SERVICE MPI PIPELINE
#
# installed: `cmake --install BUILD` to a fresh prefix, which is then moved, and found there by find_package; the program
# too, if PROGRAM is ON. With PROCESSES also what uses octopair::processes: it must run the workers' program of that tree,
# told by no environment. With SERVICE what uses octopair::client, of a server of that tree. With MPI what uses
# octopair::mpi, on two ranks. With PIPELINE what uses octopair::pipeline.
set -euo pipefail
how=$1 root=$2 build=$3 compiler=$4 with_program=$5 with_processes=$6 with_service=$7 with_mpi=$8 with_pipeline=$9
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server"; rm -rf "$work"' EXIT
unset OCTOPAIR_WORKER
prefix="$work/moved prefix"

# From now on the workers' program of the installed tree leaves a mark when it is started.
watch_worker() {
    local program=$prefix/libexec/octopair/octopair-worker
    mv "$program" "$program.real"
    printf '#!/bin/sh\ntouch "%s/started"\nexec "%s.real" "$@"\n' "$work" "$program" > "$program"
    chmod +x "$program"
}

# Runs a command, which must start the workers' program of the installed tree.
starts_worker() {
    rm -f "$work/started"
    "$@"
    test -f "$work/started" || { echo "$1 runs no worker of the installed tree" && exit 1; }
}

try_program() {
    "$prefix/bin/octopair" info
    test -f "$prefix/share/man/man1/octopair.1"
    test -f "$prefix/share/bash-completion/completions/octopair"
    [ "$with_processes" = ON ] || return 0
    printf '0,0,0,1,1,1\n5,5,5,6,6,6\n1,0,0,2,1,1\n' > "$work/boxes.csv"
    starts_worker "$prefix/bin/octopair" detect "$work/boxes.csv" --engine processes --quiet --output "$work/pairs.csv"
    [ "$(cat "$work/pairs.csv")" = $'a,b\n0,2' ]
}

# Runs a command with the address of a server of the installed tree, which is started as it is configured there.
with_server() {
    "$prefix/bin/octopair" serve --config "$prefix/share/octopair/serve.toml" --listen "unix:$work/socket" &
    server=$!
    for _ in $(seq 600); do [ -S "$work/socket" ] && break || sleep 0.1; done
    "$1" "unix:$work/socket"
    kill "$server"
    wait "$server"
    server=
}

# Its program is not where it was configured to be.
check_unit() {
    sed 's|^ExecStart=[^ ]*|ExecStart=/bin/true|' "$prefix/lib/systemd/system/octopair.service" > "$work/octopair.service"
    ! type systemd-analyze > /dev/null 2>&1 || systemd-analyze verify --man=no "$work/octopair.service"
}

# A consumer's build: NAME TARGET OPTION...
build_consumer() {
    local name=$1 target=$2
    shift 2
    cmake -S "$work/consumer" -B "$work/$name" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER="$compiler" "$@"
    cmake --build "$work/$name" --target "$target"
}

cp -r "$root/tests/install/consumer" "$work/consumer"
if [ "$how" = installed ]; then
    cmake --install "$build" --prefix "$work/prefix" > "$work/install.log"
    mv "$work/prefix" "$prefix"
    [ "$with_processes" != ON ] || watch_worker
    [ "$with_program" != ON ] || try_program
    options=(-DCMAKE_PREFIX_PATH="$prefix")
else
    options=(-DOCTOPAIR_SOURCE="$root")
fi

if [ "$how" = subdirectory ]; then
    # That each source compiles by itself, as it does for a user's build, is a check of its own.
    build_consumer tree all "${options[@]}" -DCONSUMER_WITH_PROCESSES="$with_processes" -DCONSUMER_WITH_MPI="$with_mpi" \
        -DCMAKE_UNITY_BUILD=ON
    "$work/tree/consumer"
    [ "$with_processes" != ON ] || "$work/tree/process_consumer"
    [ "$with_mpi" != ON ] || mpirun -n 2 "$work/tree/mpi_consumer"
else
    build_consumer plain consumer "${options[@]}"
    "$work/plain/consumer"
    if [ "$with_processes" = ON ]; then
        build_consumer processes process_consumer "${options[@]}" -DCONSUMER_WITH_PROCESSES=ON
        starts_worker "$work/processes/process_consumer"
    fi
    if [ "$with_mpi" = ON ]; then
        build_consumer mpi mpi_consumer "${options[@]}" -DCONSUMER_WITH_MPI=ON
        mpirun -n 2 "$work/mpi/mpi_consumer"
    fi
fi
if [ "$with_service" = ON ] && [ "$how" = installed ]; then
    build_consumer client client_consumer "${options[@]}" -DCONSUMER_WITH_CLIENT=ON
    test -f "$prefix/share/octopair/octopair.proto"
    if [ "$with_program" = ON ]; then
        check_unit
        with_server "$work/client/client_consumer"
    fi
fi
if [ "$with_pipeline" = ON ] && [ "$how" = installed ]; then
    build_consumer pipeline pipeline_consumer "${options[@]}" -DCONSUMER_WITH_PIPELINE=ON
    "$work/pipeline/pipeline_consumer"
fi
echo "a consumer of octopair ($how) finds its pairs"

#!/usr/bin/env bash
# Builds and runs consumers of octopair outside the tree.
#
#     consume.sh shared|static|subdirectory ROOT BUILD COMPILER PROGRAM PROCESSES SERVICE MPI PIPELINE VIEWER [HOST...]
#
# shared, static: installs BUILD to a fresh prefix and moves the prefix. find_package must find octopair's libraries of this
#     kind there. `shared` also tests the installed programs, the files for pkg-config and the interface for C.
# subdirectory: the consumer includes ROOT by add_subdirectory.
#
# HOST is a host of an adapter: installed adapters for these hosts are tested.
#
# The six arguments before are ON or OFF. ON also tests:
#   PROGRAM    the installed program
#   PROCESSES  octopair::processes; if installed, it must run the installed worker program without OCTOPAIR_WORKER
#   SERVICE    octopair::client, if installed; with PROGRAM, on a server of the installed program
#   MPI        octopair::mpi, on two ranks
#   PIPELINE   octopair::pipeline, if installed
#   VIEWER     octopair::viewer, if installed
set -euo pipefail
how=$1 root=$2 build=$3 compiler=$4 with_program=$5 with_processes=$6 with_service=$7 with_mpi=$8 with_pipeline=$9 with_viewer=${10}
work=$(mktemp -d)
server=
trap '[ -z "$server" ] || kill "$server"; rm -rf "$work"' EXIT
unset OCTOPAIR_WORKER
prefix="$work/moved prefix"

# Replaces the installed worker program with a script that leaves a mark and runs the worker program.
watch_worker() {
    local program=$prefix/libexec/octopair/octopair-worker
    mv "$program" "$program.real"
    printf '#!/bin/sh\ntouch "%s/started"\nexec "%s.real" "$@"\n' "$work" "$program" > "$program"
    chmod +x "$program"
}

# Runs a command. Fails unless the command starts the installed worker program.
starts_worker() {
    rm -f "$work/started"
    "$@"
    test -f "$work/started" || { echo "$1 does not run the installed worker program" && exit 1; }
}

try_program() {
    "$prefix/bin/octopair" info
    test -f "$prefix/share/man/man1/octopair.1"
    test -f "$prefix/share/bash-completion/completions/octopair"
    test -f "$prefix/share/zsh/site-functions/_octopair"
    test -f "$prefix/share/fish/vendor_completions.d/octopair.fish"
    [ "$with_processes" = ON ] || return 0
    printf '0,0,0,1,1,1\n5,5,5,6,6,6\n1,0,0,2,1,1\n' > "$work/boxes.csv"
    starts_worker "$prefix/bin/octopair" detect "$work/boxes.csv" --engine processes --quiet --output "$work/pairs.csv"
    [ "$(cat "$work/pairs.csv")" = $'a,b\n0,2' ]
}

# Starts the installed server with the installed configuration, and runs a command with the server's address.
with_server() {
    "$prefix/bin/octopair" serve --config "$prefix/share/octopair/serve.toml" --listen "unix:$work/socket" &
    server=$!
    for _ in $(seq 600); do [ -S "$work/socket" ] && break || sleep 0.1; done
    "$1" "unix:$work/socket"
    kill "$server"
    wait "$server"
    server=
}

# Verifies the systemd units, with /bin/true in place of the server: the prefix was moved away from the unit's path. The service must be
# exposed to at most 2.0 of 10 points.
check_unit() {
    cp "$prefix/lib/systemd/system/octopair.socket" "$work"
    sed 's|^ExecStart=[^ ]*|ExecStart=/bin/true|' "$prefix/lib/systemd/system/octopair.service" > "$work/octopair.service"
    systemd-analyze verify --man=no "$work/octopair.service" "$work/octopair.socket"
    systemd-analyze security --offline=true --threshold=20 "$work/octopair.service" > "$work/security.log" ||
        { tail -1 "$work/security.log"; return 1; }
}

# Fails unless a consumer loads octopair's shared libraries, or none of them, as `how` says.
check_kind() {
    local loaded=static
    ! objdump -p "$1" | grep -q 'NEEDED *liboctopair' || loaded=shared
    [ "$loaded" = "$how" ] || { echo "$1 has $loaded libraries" && exit 1; }
}

# Builds consumers without CMake: in C++ with shared and with static libraries, and in C.
try_pkgconfig() {
    export PKG_CONFIG_PATH=$prefix/lib/pkgconfig
    local flags="" libraries="" main=$root/tests/install/consumer/main.cpp
    # The prefix has a space, which pkg-config escapes for a shell.
    eval "flags=($(pkg-config --cflags octopair)) libraries=($(pkg-config --libs octopair))"
    "$compiler" -std=c++20 "${flags[@]}" "$main" "${libraries[@]}" -Wl,-rpath,"$prefix/lib" -o "$work/by_pkgconfig"
    "$work/by_pkgconfig"
    mkdir "$work/archives"
    cp "$prefix"/lib/*.a "$work/archives"
    eval "libraries=(-L'$work/archives' $(pkg-config --static --libs-only-l octopair))"
    "$compiler" -std=c++20 "${flags[@]}" "$main" "${libraries[@]}" -o "$work/static_by_pkgconfig"
    "$work/static_by_pkgconfig"
    ! objdump -p "$work/static_by_pkgconfig" | grep 'NEEDED *liboctopair' || exit 1
    for component in pipeline processes client mpi viewer; do
        [ ! -f "$PKG_CONFIG_PATH/octopair-$component.pc" ] || pkg-config --exists --print-errors "octopair-$component"
    done
    [ -f "$PKG_CONFIG_PATH/octopair-c.pc" ] || return 0
    eval "libraries=($(pkg-config --cflags --libs octopair-c))"
    cc -std=c99 "$root/examples/find_pairs.c" "${libraries[@]}" -Wl,-rpath,"$prefix/lib" -o "$work/find_pairs"
    "$work/find_pairs"
}

# NAME TARGET OPTION...: builds a target of the consumer in the folder NAME.
build_consumer() {
    local name=$1 target=$2
    shift 2
    cmake -S "$work/consumer" -B "$work/$name" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER="$compiler" "$@"
    cmake --build "$work/$name" --target "$target"
}

cp -r "$root/tests/install/consumer" "$work/consumer"
if [ "$how" != subdirectory ]; then
    cmake --install "$build" --prefix "$work/prefix" > "$work/install.log"
    mv "$work/prefix" "$prefix"
    [ "$with_processes" != ON ] || watch_worker
    [ "$with_program" != ON ] || [ "$how" = static ] || try_program
    [ "$how" = static ] || try_pkgconfig
    options=(-DCMAKE_PREFIX_PATH="$prefix" -DBUILD_SHARED_LIBS="$([ "$how" = shared ] && echo ON || echo OFF)")
else
    options=(-DOCTOPAIR_SOURCE="$root")
fi

if [ "$how" = subdirectory ]; then
    # A unity build takes less time. checks.sources_alone tests that each source compiles alone, as in a user's build.
    build_consumer tree all "${options[@]}" -DCONSUMER_WITH_PROCESSES="$with_processes" -DCONSUMER_WITH_MPI="$with_mpi" \
        -DCMAKE_UNITY_BUILD=ON
    "$work/tree/consumer"
    [ "$with_processes" != ON ] || "$work/tree/process_consumer"
    [ "$with_mpi" != ON ] || mpirun -n 2 "$work/tree/mpi_consumer"
else
    build_consumer plain consumer "${options[@]}"
    "$work/plain/consumer"
    check_kind "$work/plain/consumer"
    if [ "$with_processes" = ON ]; then
        build_consumer processes process_consumer "${options[@]}" -DCONSUMER_WITH_PROCESSES=ON
        starts_worker "$work/processes/process_consumer"
    fi
    if [ "$with_mpi" = ON ]; then
        build_consumer mpi mpi_consumer "${options[@]}" -DCONSUMER_WITH_MPI=ON
        mpirun -n 2 "$work/mpi/mpi_consumer"
    fi
fi
if [ "$with_service" = ON ] && [ "$how" != subdirectory ]; then
    build_consumer client client_consumer "${options[@]}" -DCONSUMER_WITH_CLIENT=ON
    test -f "$prefix/share/octopair/octopair.proto"
    check_kind "$work/client/client_consumer"
    if [ "$with_program" = ON ]; then
        [ "$how" = static ] || check_unit
        with_server "$work/client/client_consumer"
    fi
fi
if [ "$with_pipeline" = ON ] && [ "$how" != subdirectory ]; then
    build_consumer pipeline pipeline_consumer "${options[@]}" -DCONSUMER_WITH_PIPELINE=ON
    "$work/pipeline/pipeline_consumer"
    check_kind "$work/pipeline/pipeline_consumer"
fi
if [ "$with_viewer" = ON ] && [ "$how" != subdirectory ]; then
    build_consumer viewer viewer_consumer "${options[@]}" -DCONSUMER_WITH_VIEWER=ON
    address=$("$work/viewer/viewer_consumer")
    [[ $address == http://127.0.0.1:* ]] || { echo "viewer_consumer prints: $address" && exit 1; }
    check_kind "$work/viewer/viewer_consumer"
fi
if [ "$how" = shared ]; then
    for host in "${@:11}"; do
        build_consumer "$host" adapter_consumer "${options[@]}" -DCONSUMER_ADAPTER="$host"
        "$work/$host/adapter_consumer"
    done
fi
echo "a consumer of octopair ($how) finds its pairs"

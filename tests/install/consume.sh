#!/usr/bin/env bash
# Builds and runs a consumer of octopair outside the tree.
#
#     consume.sh installed|subdirectory ROOT BUILD COMPILER PROGRAM
#
# installed: `cmake --install BUILD` to a fresh prefix, found there by find_package; the program too, if PROGRAM is ON.
set -euo pipefail
how=$1 root=$2 build=$3 compiler=$4 with_program=$5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cp -r "$root/tests/install/consumer" "$work/consumer"
options=(-G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER="$compiler")
if [ "$how" = installed ]; then
    cmake --install "$build" --prefix "$work/prefix" > "$work/install.log"
    options+=(-DCMAKE_PREFIX_PATH="$work/prefix")
    if [ "$with_program" = ON ]; then
        "$work/prefix/bin/octopair" info
        test -f "$work/prefix/share/man/man1/octopair.1"
        test -f "$work/prefix/share/bash-completion/completions/octopair"
    fi
else
    options+=(-DOCTOPAIR_SOURCE="$root")
fi
cmake -S "$work/consumer" -B "$work/build" "${options[@]}"
cmake --build "$work/build" --target consumer
"$work/build/consumer"
echo "a consumer of octopair ($how) finds its pair"

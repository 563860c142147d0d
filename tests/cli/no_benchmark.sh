#!/usr/bin/env bash
# The program has no symbol of bench/.
#
#     no_benchmark.sh NM PROGRAM
set -euo pipefail
symbols=$("$1" -C "$2")
grep -q 'octopair::cli::' <<< "$symbols" || { echo "$2 has no symbols: nothing was checked" && exit 1; }
if grep -E 'octopair::(baselines|bench|cluster|machine|paper|scaling)::' <<< "$symbols"; then
    echo "these belong to bench/" && exit 1
fi
echo "no benchmark in the program"

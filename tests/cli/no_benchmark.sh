#!/usr/bin/env bash
# Checks that the program has no symbols of bench/.
#
#     no_benchmark.sh NM PROGRAM
set -euo pipefail
symbols=$("$1" -C "$2")
grep -q 'octopair::cli::' <<< "$symbols" || { echo "$2 has no symbols: nothing was checked" && exit 1; }
if grep -E 'octopair::(baselines|bench|cluster|machine|paper|scaling)::' <<< "$symbols"; then
    echo "the program must not have these symbols of bench/" && exit 1
fi
echo "no benchmark in the program"

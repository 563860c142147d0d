#!/usr/bin/env bash
# Tests that the installed tree has octopair-bench with its manual page, and that the program runs there.
#
#     installed.sh BUILD
set -euo pipefail
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT

cmake --install "$1" --prefix "$prefix" > /dev/null
test -f "$prefix/share/man/man1/octopair-bench.1" || { echo "the manual page is not installed" && exit 1; }
"$prefix/bin/octopair-bench" paper --objects 1000 --rounds 1 --threads 1 --quiet

#!/usr/bin/env bash
# Runs a program that was linked with the shared library of the packages, with a library of another build.
#
#     rebuilt.sh PACKAGES FOLDER     FOLDER: has liboctopair.so of the other build
set -euo pipefail
packages=$1 folder=$2
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for package in "$packages"/liboctopair{2,-dev}_*.deb; do dpkg-deb -x "$package" "$work"; done
library=$(dirname "$(find "$work" -name liboctopair.so.2)")
"$root/packaging/debian/tests/block" "$root/README.md" "Ten lines of C++" cpp > "$work/mine.cpp"
"${CXX:-c++}" -std=c++20 -I "$work/usr/include" "$work/mine.cpp" -L "$library" -loctopair -Wl,-rpath-link,"$library" -o "$work/mine"
"${CXX:-c++}" -std=c++20 -I "$work/usr/include" "$root/examples/bounce.cpp" -L "$library" -loctopair -Wl,-rpath-link,"$library" -o "$work/bounce"
for libraries in "$library" "$folder"; do
    export LD_LIBRARY_PATH=$libraries
    ldd "$work/mine" | grep -q "$libraries/liboctopair.so.2" || { echo "the program does not load the library in $libraries" && exit 1; }
    [ "$("$work/mine")" = "0 and 2" ] || { echo "wrong pairs with the library in $libraries" && exit 1; }
    "$work/bounce" > /dev/null
done
! objdump -p "$work/mine" "$work/bounce" | grep OCTOPAIR_PRIVATE || { echo "a program needs private symbols" && exit 1; }
echo "a program of the packages runs with a rebuilt library"

#!/usr/bin/env bash
# Checks that programs which were linked with an earlier release run with the shared libraries of these packages.
#
#     abi.sh PACKAGES             compares the interfaces of the libraries in PACKAGES/*.deb with abi/*.abi
#     abi.sh --update PACKAGES    writes abi/*.abi; only for a release, or with a new SONAME
#
# An interface may grow. A function that is missing, and a type with another layout, are errors. The descriptions are those of
# abidw, which reads debug information (PACKAGES/debug). Without debug information, the libraries are compiled here, with debug information
# and without optimisation: an interface does not depend on these.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
soversion=$(sed -n 's/^set(OCTOPAIR_SOVERSION \([0-9]*\))/\1/p' "$here/../../CMakeLists.txt")
update=
if [ "${1:-}" = --update ]; then update=1 && shift; fi
packages=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for package in "$packages"/liboctopair*.deb "$packages"/debug/*.deb; do
    [ ! -f "$package" ] || dpkg-deb -x "$package" "$work"
done
names="octopair octopair_c octopair_client octopair_mpi octopair_pipeline octopair_processes octopair_viewer"
libraries=$work
if ! compgen -G "$packages/debug/*.deb" > /dev/null; then
    source "$here/../../scripts/common.sh"
    compile_through_ccache
    libraries=$root/build/abi
    # One unity file for each library, because reading headers takes most of the time.
    cmake -S "$root" -B "$libraries" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-g -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 \
        -DOCTOPAIR_BUILD_TESTS=OFF -DOCTOPAIR_BUILD_PROGRAM=OFF -DOCTOPAIR_WITH_VIEWER=ON > "$work/log"
    targets=$(for name in $names; do [ "$name" = octopair_c ] && echo octopair_c || echo "${name}_shared"; done)
    # shellcheck disable=SC2086
    cmake --build "$libraries" --target $targets > "$work/log" || { tail -30 "$work/log" && exit 1; }
fi

# What belongs to the interface: the types of the public headers.
public=(--drop-private-types --exported-interfaces-only)

# Describes the interface of a library: describe LIBRARY FILE.
describe() {
    abidw --headers-dir "$work/usr/include" "${public[@]}" \
        --suppressions "$here/abi/suppressions" --debug-info-dir "$work/usr/lib/debug" --no-corpus-path --no-comp-dir-path \
        --no-show-locs --no-elf-needed --no-parameter-names --out-file "$2" "$1"
}

# Succeeds if programs for the described library run with this one: fits DESCRIPTION LIBRARY.
fits() {
    abidiff --headers-dir2 "$work/usr/include" "${public[@]}" --debug-info-dir2 "$work/usr/lib/debug" \
        --suppressions "$here/abi/suppressions" --no-added-syms "$1" "$2" > "$work/report" 2>&1
}

bad=0
for name in $names; do
    find "$work/usr" -path "*/debug/*" -prune -o -name "lib$name.so.*.*" -print | grep -q . || { echo "lib$name is in no package" && exit 1; }
    library=$(find "$libraries" -path "*/debug/*" -prune -o -type f -name "lib$name.so.*.*" -print)
    soname=$(objdump -p "$library" | awk '$1 == "SONAME" { print $2 }')
    [ "$soname" = "lib$name.so.$soversion" ] || { echo "lib$name has the SONAME $soname" && exit 1; }
    describe "$library" "$work/$name.abi"
    grep -q "<function-decl" "$work/$name.abi" || { echo "lib$name: no debug information" && exit 1; }
    if [ -n "$update" ]; then
        cp "$work/$name.abi" "$here/abi/$name.abi"
    elif [ ! -f "$here/abi/$name.abi" ]; then
        echo "lib$name: new since the last release"
    elif ! fits "$here/abi/$name.abi" "$library"; then
        echo "lib$name: programs of an earlier release may fail with this library"
        cat "$work/report"
        bad=1
    fi
done
[ -z "$update" ] || exit 0

# A planted change must be found: one more member in Options.
sed "/class-decl name='Options'/s/size-in-bits='[0-9]*'/size-in-bits='4096'/" "$work/octopair.abi" > "$work/planted.abi"
! cmp -s "$work/octopair.abi" "$work/planted.abi" || { echo "no struct Options to change" && exit 1; }
! fits "$work/planted.abi" "$(find "$libraries" -path "*/debug/*" -prune -o -type f -name "liboctopair.so.*.*" -print)" || { echo "a struct of another size was not found" && exit 1; }
exit $bad

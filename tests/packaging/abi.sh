#!/usr/bin/env bash
# Checks that programs which were linked with an earlier release run with the shared libraries of these packages.
#
#     abi.sh PACKAGES             compares the interfaces of the libraries in PACKAGES/*.deb with abi/*.abi.xz
#     abi.sh --update PACKAGES    writes abi/*.abi.xz; only for a release, or with a new SONAME
#
# An interface may grow. A function that is missing, and a type with another layout, are errors. The descriptions are those of
# abidw, which reads debug information (PACKAGES/debug). They are compressed; `xzless abi/octopair.abi.xz` shows one.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
soversion=$(sed -n 's/^set(OCTOPAIR_SOVERSION \([0-9]*\))/\1/p' "$here/../../CMakeLists.txt")
update=
if [ "${1:-}" = --update ]; then update=1 && shift; fi
packages=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for package in "$packages"/liboctopair*.deb "$packages"/debug/*.deb; do dpkg-deb -x "$package" "$work"; done

# Describes the interface of a library: describe LIBRARY FILE.
describe() {
    abidw --headers-dir "$work/usr/include" --drop-private-types --exported-interfaces-only \
        --suppressions "$here/abi/suppressions" --debug-info-dir "$work/usr/lib/debug" --no-corpus-path --no-comp-dir-path \
        --no-show-locs --no-elf-needed --no-parameter-names --out-file "$2" "$1"
}

# Compares two descriptions. Succeeds if programs for the first one run with the second one.
fits() { abidiff --suppressions "$here/abi/suppressions" --no-added-syms "$1" "$2" > "$work/report" 2>&1; }

bad=0
for name in octopair octopair_c octopair_client octopair_mpi octopair_pipeline octopair_processes octopair_viewer; do
    library=$(find "$work" -path "*/debug/*" -prune -o -name "lib$name.so.*.*" -print)
    [ -n "$library" ] || { echo "lib$name is in no package" && exit 1; }
    soname=$(objdump -p "$library" | awk '$1 == "SONAME" { print $2 }')
    [ "$soname" = "lib$name.so.$soversion" ] || { echo "lib$name has the SONAME $soname" && exit 1; }
    describe "$library" "$work/$name.abi"
    grep -q "<function-decl" "$work/$name.abi" || { echo "lib$name: no debug information" && exit 1; }
    if [ -n "$update" ]; then
        # One thread: equal descriptions give equal bytes on each machine.
        xz -9 --threads=1 --stdout "$work/$name.abi" > "$here/abi/$name.abi.xz"
        continue
    elif [ ! -f "$here/abi/$name.abi.xz" ]; then
        echo "lib$name: new since the last release"
        continue
    fi
    xz --decompress --stdout "$here/abi/$name.abi.xz" > "$work/$name.released.abi"
    if ! fits "$work/$name.released.abi" "$work/$name.abi"; then
        echo "lib$name: programs of an earlier release may fail with this library"
        cat "$work/report"
        bad=1
    fi
done
[ -z "$update" ] || exit 0

# A planted change must be found: one more member in Options.
sed "/class-decl name='Options'/s/size-in-bits='[0-9]*'/size-in-bits='4096'/" "$work/octopair.abi" > "$work/planted.abi"
! cmp -s "$work/octopair.abi" "$work/planted.abi" || { echo "no struct Options to change" && exit 1; }
! fits "$work/planted.abi" "$work/octopair.abi" || { echo "a struct of another size was not found" && exit 1; }
exit $bad

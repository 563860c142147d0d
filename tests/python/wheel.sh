#!/usr/bin/env bash
# Installs the package as a user does, and checks what the wheel contains.
#
#     wheel.sh SOURCE_DIR PYTHON
#
#   1. makes a source distribution, unpacks it, and builds the wheel from it with pip
#   2. checks that the build has the options of build/release, uses ccache, and shows its progress in a pipe and on a terminal
#   3. installs the wheel alone in a fresh environment
#   4. checks that the modules and programs link only libraries of the wheel, the C and C++ libraries, and MPI
#   5. checks that each file needs only versions of the C and C++ libraries that the oldest systems have, which the wheel names
#   6. runs examples with each engine, and the command octopair
set -euo pipefail
source_dir=$1 python=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
    echo "wheel.sh: $*" >&2
    exit 1
}
unset PYTHONPATH CXXFLAGS OCTOPAIR_WORKER OCTOPAIR_PROGRAM

cd "$source_dir"
"$python" setup.py -q egg_info --egg-base "$work" sdist --dist-dir "$work" > "$work/log" 2>&1 || { cat "$work/log"; fail "no source distribution"; }
tar -xf "$work"/octopair-*.tar.gz -C "$work"
rm "$work"/octopair-*.tar.gz
cd "$work"/octopair-*
# The build takes the objects of the preset `release` from ccache, because it has the options of build/release, and its folder is as deep.
# These are the options with which the stages of tests build (tests/packaging/release_objects.sh).
mkdir -p build/release
echo "CMAKE_CXX_FLAGS:STRING=-g -fno-var-tracking
OCTOPAIR_WARNINGS_AS_ERRORS:BOOL=ON" > build/release/CMakeCache.txt
export LDFLAGS=-s CCACHE_STATSLOG=$work/ccache
"$python" -m venv --system-site-packages "$work/build"
build=("$work/build/bin/pip" wheel --no-deps --no-build-isolation --wheel-dir)
"${build[@]}" "$work/wheel" . 2>&1 < /dev/null | cat > "$work/log" || { tail -40 "$work/log"; fail "no wheel"; }
grep -qE 'octopair: compiling [0-9]+0 of [0-9]+$' "$work/log" || { cat "$work/log"; fail "pip showed no progress in a pipe"; }
while read -r option; do
    grep -qxF -e "$option" build/wheel/CMakeCache.txt || fail "the build of the wheel does not have $option, as build/release"
done < build/release/CMakeCache.txt

# A second build compiles only what changed, and ccache has the object. If glibc 2.2 is the oldest, all files need a later version, so the
# wheel names no oldest system.
touch python/src/octants.cpp
sed -i 's/"GLIBC": (2, 35)/"GLIBC": (2, 2)/' setup.py
: > "$CCACHE_STATSLOG"
script -qefc "${build[*]} '$work/later' ." /dev/null < /dev/null > "$work/log" 2>&1 || { tail -40 "$work/log"; fail "no second wheel"; }
grep -aqE ' compiling [0-9]+ of [0-9]+ ' "$work/log" || { cat "$work/log"; fail "pip showed no progress on a terminal"; }
if command -v ccache > /dev/null; then
    sed -n '/^# .*octopair_python_core/,/^#/p' "$CCACHE_STATSLOG" | grep '_cache_hit$' > "$work/hits" ||
        fail "the second build did not take its object from ccache"
    [ "$(grep -cE '^# (.*/)?(src|python)/' "$CCACHE_STATSLOG")" = 1 ] || fail "the second build compiled again: $(grep '^#' "$CCACHE_STATSLOG")"
fi
[[ $(echo "$work"/later/*.whl) == *-linux_$(uname -m).whl ]] || fail "the wheel for later systems is $(ls "$work/later")"
cd "$work"
rm -rf "$work"/octopair-*

"$python" -m venv --system-site-packages "$work/fresh"
"$work/fresh/bin/pip" install --no-index "$work"/wheel/octopair-*.whl > "$work/log" 2>&1 || { cat "$work/log"; fail "cannot install the wheel"; }
package=$("$work/fresh/bin/python" -c 'import octopair, pathlib; print(pathlib.Path(octopair.__file__).parent)')
[[ $package == "$work"/fresh/* ]] || fail "imported $package"

# All programs, modules and libraries of the wheel.
mapfile -t files < <(find "$package" -type f -exec sh -c 'head -c 4 "$1" | grep -aq ELF' sh {} \; -print)
[ ${#files[@]} -gt 20 ] || fail "few programs and libraries: ${files[*]}"
system='^(linux-vdso|/lib64/ld-linux|libc\.|libm\.|libdl\.|librt\.|libpthread\.|libresolv\.|libstdc\+\+\.|libgcc_s\.)'
for file in "${files[@]}"; do
    # Ranks run with the MPI of the system, so its module links that. A module or program says where the libraries of a library are.
    [[ $file != */_mpi.* && $file != */lib/* ]] || continue
    others=$(ldd "$file" | awk '{ print $1, $3 }' | grep -v "$package" | grep -Ev "$system" || true)
    [ -z "$others" ] || fail "$(basename "$file") links libraries that the wheel does not contain: $others"
done
if compgen -G "$package/lib/libmpi*" > /dev/null; then fail "the wheel contains MPI"; fi

# The wheel names the oldest systems in its tag and its description. These are the versions of symbols that they have.
for file in "${files[@]}"; do
    readelf --version-info --wide "$file" | awk -v file="${file#"$package/"}" '/^Version / { needs = /needs/ }
        needs && match($0, /Name: [^ ]+/) { print substr($0, RSTART + 6, RLENGTH - 6), file }'
done > "$work/needed"
for oldest in GLIBC_2.35 GLIBCXX_3.4.30 CXXABI_1.3.13 GCC_12.0.0; do
    grep "^${oldest%%_*}_" "$work/needed" | sort -V > "$work/versions" || fail "no file needs a version of ${oldest%%_*}"
    highest=$(tail -1 "$work/versions")
    [ "$(printf '%s\n' "${highest% *}" "$oldest" | sort -V | tail -1)" = "$oldest" ] ||
        fail "the oldest systems have $oldest, but these files need a later version: $(grep "^${highest% *} " "$work/versions")"
done
[[ $(echo "$work"/wheel/*.whl) == *-manylinux_2_35_$(uname -m).whl ]] || fail "the wheel is $(ls "$work/wheel")"
tr '\n' ' ' < "$(echo "$package"/../octopair-*.dist-info/METADATA)" > "$work/description"
for words in "glibc 2.35" GLIBCXX_3.4.30 CXXABI_1.3.13 "Ubuntu 22.04" "Debian 12"; do
    grep -qF "$words" "$work/description" || fail "the description of the wheel does not name $words"
done

"$work/fresh/bin/python" - << 'END'
import numpy as np, octopair as op, octopair.trimesh
boxes = op.generate("uniform", 5000, seed=1)
expected = op.find_pairs(boxes)
assert len(expected) > 1000
assert op.Engine("processes", workers=2).find_pairs(boxes).tobytes() == expected.tobytes()
np.save("boxes.npy", boxes)
assert op.detect("boxes.npy").pairs.tobytes() == expected.tobytes()
import zipfile
model = ('<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><object id="1"><mesh><vertices>'
         '<vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles>'
         '<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/><triangle v1="0" v2="3" v3="2"/><triangle v1="1" v2="2" v3="3"/>'
         '</triangles></mesh></object></resources><build><item objectid="1"/><item objectid="1"/></build></model>')
with zipfile.ZipFile("parts.3mf", "w") as file:  # XML: the wheel has an expat of its own
    file.writestr("_rels/.rels", '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="a" '
                  'Target="/a.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
    file.writestr("a.model", model)
assert op.detect("parts.3mf").pairs.tolist() == [[0, 1]]
import importlib.util
if importlib.util.find_spec("octopair._remote"):
    import os, subprocess, time
    from octopair._program import program_path
    server = subprocess.Popen([program_path(), "serve", "--listen", f"unix:{os.getcwd()}/socket", "--quiet"])
    while not os.path.exists("socket"):
        assert server.poll() is None
        time.sleep(0.02)
    assert op.Engine(f"unix:{os.getcwd()}/socket").find_pairs(boxes).tobytes() == expected.tobytes()
    server.terminate()
    assert server.wait() == 0
END
"$work/fresh/bin/octopair" detect boxes.npy --count-only --quiet > count
[ "$(cat count)" -gt 1000 ] || fail "the command octopair does not work"
"$work/fresh/bin/pip" uninstall -y -q octopair
[ ! -e "$package" ] || fail "files are left after removal: $(find "$package")"

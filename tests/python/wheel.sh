#!/usr/bin/env bash
# Installs the package as a user does, and checks what the wheel contains.
#
#     wheel.sh SOURCE_DIR PYTHON
#
#   1. makes a source distribution, unpacks it, and builds the wheel from it with pip
#   2. checks that the build has the options of build/release, uses ccache, and shows its progress in a pipe and on a terminal
#   3. installs the wheel alone in a fresh environment
#   4. checks that each module and program links only libraries of the wheel, the C library, and MPI
#   5. runs examples with each engine, and the command octopair
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

# A second build compiles only what changed, and ccache has the object.
touch python/src/octants.cpp
: > "$CCACHE_STATSLOG"
script -qefc "${build[*]} '$work/later' ." /dev/null < /dev/null > "$work/log" 2>&1 || { tail -40 "$work/log"; fail "no second wheel"; }
grep -aqE ' compiling [0-9]+ of [0-9]+ ' "$work/log" || { cat "$work/log"; fail "pip showed no progress on a terminal"; }
if command -v ccache > /dev/null; then
    sed -n '/^# .*octopair_python_core/,/^#/p' "$CCACHE_STATSLOG" | grep '_cache_hit$' > "$work/hits" ||
        fail "the second build did not take its object from ccache"
    [ "$(grep -cE '^# (.*/)?(src|python)/' "$CCACHE_STATSLOG")" = 1 ] || fail "the second build compiled again: $(grep '^#' "$CCACHE_STATSLOG")"
fi
cd "$work"
rm -rf "$work"/octopair-*

"$python" -m venv --system-site-packages "$work/fresh"
"$work/fresh/bin/pip" install --no-index "$work"/wheel/octopair-*.whl > "$work/log" 2>&1 || { cat "$work/log"; fail "cannot install the wheel"; }
package=$("$work/fresh/bin/python" -c 'import octopair, pathlib; print(pathlib.Path(octopair.__file__).parent)')
[[ $package == "$work"/fresh/* ]] || fail "imported $package"

system='^(linux-vdso|/lib64/ld-linux|libc\.|libm\.|libdl\.|librt\.|libpthread\.|libresolv\.)'
for file in "$package"/_core*.so "$package"/_remote*.so "$package"/bin/*; do
    others=$(ldd "$file" | awk '{ print $1, $3 }' | grep -v "$package" | grep -Ev "$system" || true)
    [ -z "$others" ] || fail "$(basename "$file") links libraries that the wheel does not contain: $others"
done
if compgen -G "$package/lib/libmpi*" > /dev/null; then fail "the wheel contains MPI"; fi

"$work/fresh/bin/python" - << 'END'
import numpy as np, octopair as op, octopair.trimesh
boxes = op.generate("uniform", 5000, seed=1)
expected = op.find_pairs(boxes)
assert len(expected) > 1000
assert op.Engine("processes", workers=2).find_pairs(boxes).tobytes() == expected.tobytes()
np.save("boxes.npy", boxes)
assert op.detect("boxes.npy").pairs.tobytes() == expected.tobytes()
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

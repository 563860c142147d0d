#!/usr/bin/env bash
# Installs the package as a user does, and checks what the wheel contains.
#
#     wheel.sh SOURCE_DIR PYTHON
#
#   1. makes a source distribution, unpacks it, and builds the wheel from it with pip in a virtual environment
#   2. installs the wheel alone in a fresh environment
#   3. checks that each module and program links only libraries of the wheel, the C library, and MPI
#   4. runs examples with each engine, and the command octopair
set -euo pipefail
source_dir=$1 python=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
    echo "wheel.sh: $*" >&2
    exit 1
}
unset PYTHONPATH OCTOPAIR_WORKER OCTOPAIR_PROGRAM

cd "$source_dir"
"$python" setup.py -q egg_info --egg-base "$work" sdist --dist-dir "$work" > "$work/log" 2>&1 || { cat "$work/log"; fail "no source distribution"; }
tar -xf "$work"/octopair-*.tar.gz -C "$work"
rm "$work"/octopair-*.tar.gz
cd "$work"/octopair-*
# The build takes the objects of the preset `release` from ccache, because its folder is as deep as those of the presets, and its
# options are the same (tests/packaging/release_objects.sh).
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 SKBUILD_CONFIGURE_OPTIONS=-DOCTOPAIR_WARNINGS_AS_ERRORS=ON \
    CXXFLAGS="-g -fno-var-tracking" LDFLAGS=-s
folder=$("$python" -c 'from skbuild.constants import CMAKE_BUILD_DIR; print(CMAKE_BUILD_DIR())')
mkdir -p build/wheel "$(dirname "$folder")"
ln -s "$PWD/build/wheel" "$folder"
"$python" -m venv --system-site-packages "$work/build"
"$work/build/bin/pip" wheel --no-deps --no-build-isolation --wheel-dir "$work/wheel" . > "$work/log" 2>&1 || { tail -40 "$work/log"; fail "no wheel"; }
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

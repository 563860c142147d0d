# Functions common to the scripts; source from bash with set -euo pipefail. All messages go to standard error.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { echo "$(basename "$0"): $*" >&2; }
fail() {
    say "$*"
    exit 1
}

# Folder with the libraries of the viewer's page (viewer/install.mjs), for tests of the page.
export OCTOPAIR_NPM_FOLDER=${OCTOPAIR_NPM_FOLDER:-$root/build/npm}

# Prints the packages of a component that this machine needs, one per line. Lines of its list:
#     PACKAGE             always needed
#     ?COMMAND PACKAGE    needed if the command is missing: it may be from another package than Debian's
#     +NAME               the packages of the component NAME
packages_of() {
    local list="$root/scripts/packages/$1.txt" first second
    [ -f "$list" ] || fail "no component '$1'; there are: $(cd "$root/scripts/packages" && ls ./*.txt | sed 's|./||; s|.txt||' | xargs)"
    while read -r first second; do
        case $first in
            +*) packages_of "${first#+}" ;;
            \?*) command -v "${first#\?}" > /dev/null || echo "$second" ;;
            *) echo "$first" ;;
        esac
    done < <(sed 's/#.*//' "$list" | awk 'NF { print $1, $2 }')
}

# Runs a command as root: directly, or through sudo.
as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif command -v sudo > /dev/null; then
        sudo "$@"
    else
        fail "needs root or sudo for: $*"
    fi
}

# Fetches the package lists, once per run of a script.
update_package_lists() {
    [ -z "${OCTOPAIR_LISTS_UPDATED:-}" ] || return 0
    say "fetching the package lists"
    as_root apt-get update -qq >&2 || return 1
    export OCTOPAIR_LISTS_UPDATED=1
}

# Runs a command that downloads packages: first with the package lists of this machine, so that no other package has to be upgraded;
# then, if the mirror no longer has these versions, with new lists.
with_package_lists() {
    "$@" || { update_package_lists && "$@"; }
}

# Makes CMake compile through ccache, if installed. Checkouts share the cache, because paths are relative to the root. The
# sloppiness lets precompiled headers in; no source uses the time of its compilation.
compile_through_ccache() {
    command -v ccache > /dev/null || return 0
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR="$root" CCACHE_NOHASHDIR=1 \
        CCACHE_SLOPPINESS=pch_defines,time_macros,locale
}

# Prints the version of the project.
project_version() { sed -n 's/^project(octopair VERSION \([0-9.]*\) .*/\1/p' "$root/CMakeLists.txt"; }

# Prints the time of all files that a release contains, in seconds since 1970: SOURCE_DATE_EPOCH, else the time of the last
# commit, else that of CHANGELOG.md.
source_epoch() {
    if [ -n "${SOURCE_DATE_EPOCH:-}" ]; then
        echo "$SOURCE_DATE_EPOCH"
    else
        git -C "$root" log -1 --format=%ct 2> /dev/null || stat -c %Y "$root/CHANGELOG.md"
    fi
}

# Writes the last commit as the archive FILE (.tar.gz), with the same bytes each time. Outside of git: this folder without build/.
source_archive() {
    local name
    name="octopair-$(project_version)"
    if git -C "$root" rev-parse --verify -q HEAD > /dev/null 2>&1; then
        git -C "$root" archive --format=tar --prefix="$name/" HEAD
    else
        tar -C "$root" --exclude=./build --exclude=./viewer/node_modules --exclude=./viewer/page.html --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$(source_epoch)" \
            --transform="s|^\.|$name|" -c .
    fi | gzip -n -9 > "$1"
}

# Prints the folder that a script writes: its argument, or DEFAULT. Refuses options, and more than one argument:
# output_folder DEFAULT [ARGUMENT...].
output_folder() {
    [ $# -le 2 ] && [[ ${2:-} != -* ]] || fail "takes one folder; default: ${1#"$root/"}"
    realpath -m "${2:-$1}"
}

# Fails unless a result may take the place of FOLDER: check_replaceable FOLDER MARK. An earlier result has a file that matches the
# pattern MARK. An empty folder may be replaced, too.
check_replaceable() {
    [ ! -e "$1" ] || compgen -G "$1/$2" > /dev/null || rmdir "$1" 2> /dev/null ||
        fail "$1 is not empty, and no earlier result; name another folder"
}

# Moves a folder to the place of an earlier result: replace_folder NEW FOLDER MARK.
replace_folder() {
    check_replaceable "$2" "$3"
    rm -rf "$2"
    mkdir -p "$(dirname "$2")"
    mv "$1" "$2"
}

#!/usr/bin/env bash
# Compiles each header of include/ and src/ alone.
#
#     headers_alone.sh COMPILER ROOT BUILD [DIRECTORY...]
#
# BUILD holds include/octopair/version.hpp, and what protoc wrote; the directories are those of other libraries' headers.
# Through ccache, where there is one: what has not changed since it compiled last is known to compile.
set -uo pipefail
compiler=$1 root=$2 build=$3
libraries=$(printf -- "-isystem %s " "${@:4}")
work=$build/headers_alone/$(basename "$compiler")
mkdir -p "$work"
trap 'rm -rf "$work"' EXIT
cache=$(command -v ccache || true)
how=-c
[ -n "$cache" ] || how=-fsyntax-only

alone() {
    local header=$1
    # A kernel that Highway includes once for each instruction set is no header of its own.
    grep -q '^#pragma once' "$root/$header" || return 0
    # The same text in every checkout, so that one knows what another compiled.
    local name=${header#*/} source
    source=$work/${name//\//_}.cpp
    printf '#include "%s"\n#include "%s"\n' "$name" "$name" > "$source"
    $cache "$compiler" -std=c++20 -Wall -Wextra -Wpedantic -Werror $how "$source" -o "$source.o" \
        -I "$root/include" -I "$root/src" -I "$build/include" -isystem "$build/src/service/generated" $libraries ||
        { echo "$header does not compile alone" && return 1; }
    rm -f "$source.o"
}
export -f alone
export compiler root build libraries work cache how

cd "$build" || exit 1
headers=$(cd "$root" && find include src -name '*.hpp' | sort)
xargs -P "$(nproc)" -I{} bash -c 'alone {}' <<< "$headers" || exit 1
echo "$(wc -l <<< "$headers") headers compile alone with $compiler"

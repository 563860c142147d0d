#!/usr/bin/env bash
# Compiles each header of include/ and src/ alone.
#
#     headers_alone.sh COMPILER ROOT BUILD [DIRECTORY...]
#
# BUILD holds include/octopair/version.hpp, and what protoc wrote; the directories are those of other libraries' headers.
set -uo pipefail
compiler=$1 root=$2 build=$3
libraries=$(printf -- "-isystem %s " "${@:4}")

alone() {
    local header=$1
    # A kernel that Highway includes once for each instruction set is no header of its own.
    grep -q '^#pragma once' "$header" || return 0
    printf '#include "%s"\n#include "%s"\n' "$header" "$header" |
        "$compiler" -std=c++20 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -x c++ \
            -I "$root/include" -I "$root/src" -I "$build/include" -isystem "$build/src/service/generated" $libraries - ||
        { echo "$header does not compile alone" && return 1; }
}
export -f alone
export compiler root build libraries

headers=$(find "$root/include" "$root/src" -name '*.hpp' | sort)
xargs -P "$(nproc)" -I{} bash -c 'alone {}' <<< "$headers" || exit 1
echo "$(wc -l <<< "$headers") headers compile alone with $compiler"

#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) on the library and the program: tidy.sh CLANG_TIDY ROOT BUILD
#
# BUILD holds compile_commands.json. A file that passed is not looked at again until it, a header, the rules or the
# build change; what passed is noted in the cache of the user, so that holds for all checkouts.
set -uo pipefail
clang_tidy=$1 root=$2 build=$3
passed="${XDG_CACHE_HOME:-${HOME:-$build}/.cache}/octopair/tidy"
mkdir -p "$passed"

rules=$( ("$clang_tidy" --version && cat "$root/.clang-tidy" && sed "s#$root##g" "$build/compile_commands.json" &&
    find "$root/include" "$root/src" -name '*.hpp' -print0 | sort -z | xargs -0 cat) | sha256sum)

tidy() {
    local file=$1 mark
    mark="$passed/$( (echo "$rules ${file#"$root"}" && cat "$file") | sha256sum | cut -c 1-32)"
    [ ! -e "$mark" ] || return 0
    "$clang_tidy" --quiet -p "$build" "$file" 2> >(grep -vE '^[0-9]+ warnings? (generated|treated)|^Suppressed|^$' >&2) || return 1
    touch "$mark"
}
export -f tidy
export clang_tidy build passed rules root

mapfile -t files < <(grep -o '"file": "[^"]*"' "$build/compile_commands.json" | cut -d '"' -f 4 | grep "^$root/src/" | sort -u)
[ ${#files[@]} -gt 0 ] || { echo "no file of src/ in $build/compile_commands.json" && exit 1; }
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -I{} bash -c 'tidy {}' || exit 1
echo "${#files[@]} files are tidy"

#!/usr/bin/env bash
# Checks the format of all C++ files: format.sh CLANG_FORMAT ROOT. To format them: format.sh CLANG_FORMAT ROOT -i
set -euo pipefail
clang_format=$1 root=$2 how=${3:---dry-run}
cd "$root"
folders=()
for folder in include src c python bench tests examples; do [ ! -d $folder ] || folders+=("$folder"); done
mapfile -t files < <(find "${folders[@]}" -name wrong_tree -prune -o -name '*.[ch]pp' -print | sort)
"$clang_format" "$how" --Werror "${files[@]}"
echo "${#files[@]} files have the format of .clang-format"

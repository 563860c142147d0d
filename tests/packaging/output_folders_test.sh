#!/usr/bin/env bash
# Checks that scripts refuse options that they do not have, and never replace a folder that is not theirs.
#
#     output_folders_test.sh ROOT
set -euo pipefail
root=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Fails unless a command fails with a message that contains WORDS: refused WORDS COMMAND...
refused() {
    local words=$1
    shift
    if timeout 20 "$@" > "$work/log" 2>&1; then echo "not refused: $*" && exit 1; fi
    grep -q "$words" "$work/log" || { echo "$*: another message:" && cat "$work/log" && exit 1; }
}

cd "$work"
for script in docs package release; do
    refused "takes one folder" "$root/scripts/$script" --help
    refused "takes one folder" "$root/scripts/$script" one two
done
mkdir -p mine/source
touch mine/source/notes mine/SHA256SUMS
for script in package release; do refused "no earlier result" "$root/scripts/$script" "$work/mine"; done
[ -f mine/source/notes ] || { echo "a file of the user is gone" && exit 1; }

# An earlier result and an empty folder may be replaced.
source "$root/scripts/common.sh"
mkdir -p empty earlier/source
touch earlier/source/octopair_1.dsc
check_replaceable "$work/empty" "source/octopair_*.dsc"
check_replaceable "$work/earlier" "source/octopair_*.dsc"
echo "the scripts replace only their own folders"

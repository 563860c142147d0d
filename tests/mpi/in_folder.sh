# Common beginning of scripts that run ranks. A script with the arguments PROGRAM MPIRUN sources this file, and then
# works in a temporary folder, which is removed when the script ends.
set -euo pipefail
program=$1 mpirun=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

fail() { echo "$*" && exit 1; }
on_ranks() { "$mpirun" -n "$1" "$program" "${@:2}"; }

# RANKS NAME ARGUMENTS...: fails unless ranks write the same file as threads.
same() {
    local ranks=$1 name=$2
    shift 2
    "$program" detect "$@" --output "local.$name" --quiet
    on_ranks "$ranks" detect "$@" --engine mpi --output "ranks.$name" --quiet
    cmp "local.$name" "ranks.$name" || fail "$ranks ranks give another $name for: $*"
}

# STATUS WORDS ARGUMENTS...: checks that `detect` fails with STATUS, prints one message with WORDS, and leaves no file.
refuses() {
    local status=$1 words=$2 got=0
    shift 2
    on_ranks 3 detect "$@" --engine mpi --output no.npy --quiet 2> errors.txt || got=$?
    [ "$got" = "$status" ] || fail "exit status $got, not $status, for: $*: $(cat errors.txt)"
    [ "$(grep -c "octopair: .*$words" errors.txt)" = 1 ] || fail "not printed once: $words: $(cat errors.txt)"
    [ ! -e no.npy ] || fail "a file is left by: $*"
    [ -z "$(find . -name '*.tmp')" ] || fail "a temporary file is left by: $*"
}

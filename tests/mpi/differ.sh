#!/usr/bin/env bash
# Tests that ranks with other options or inputs than rank 0 end all ranks, with one message that names the difference.
#
#     differ.sh PROGRAM MPIRUN
source "$(dirname "$(realpath "$0")")/in_folder.sh"

# Rank 0 runs in the folder one, rank 1 runs in the folder other, like hosts that have copies of their own.
# FIRST OTHER: runs `octopair FIRST` on rank 0, and `octopair OTHER` on rank 1.
run_both() {
    # shellcheck disable=SC2086
    timeout 30 "$mpirun" -n 1 --wdir "$work/one" "$program" $1 : -n 1 --wdir "$work/other" "$program" $2
}

# WORDS FIRST OTHER: fails unless the ranks end with status 2 and say WORDS once.
differ() {
    local got=0
    run_both "$2" "$3" > out.txt 2> errors.txt || got=$?
    [ "$got" = 2 ] || fail "exit status $got for '$2' and '$3': $(cat errors.txt)"
    [ "$(grep -c "octopair: ranks 0 and 1 differ in $1" errors.txt)" = 1 ] || fail "not printed once: $1: $(cat errors.txt)"
    [ ! -s out.txt ] || fail "output of '$2' and '$3': $(cat out.txt)"
    [ -z "$(find . -name 'no.*')" ] || fail "a file is left by '$2' and '$3'"
}

mkdir one other
"$program" generate dense --objects 3000 --seed 1 --output one/a.npy --quiet
"$program" generate dense --objects 3000 --seed 2 --output other/a.npy --quiet
"$program" generate dense --objects 3001 --seed 1 --output other/more.npy --quiet
"$program" generate brownian --objects 3000 --frames 2 --seed 1 --output other/moving.npy --quiet
cp one/a.npy other/copy.npy
same="detect --engine mpi --quiet"

[ "$(run_both "$same a.npy --count-only" "$same copy.npy --count-only --threads 2")" = \
    "$("$program" detect one/a.npy --count-only --quiet)" ] || fail "a copy with another name gives another number"

# A stale copy with the same name, in each kind of run.
for words in "--output no.npy" --count-only "--verify --count-only"; do
    differ "the content of input 1: checksum .* (a.npy), checksum .* (a.npy)" "$same a.npy $words" "$same a.npy $words"
done
differ "the number of objects of INPUT: 3000, 3001" "$same a.npy --count-only" "$same more.npy --count-only"
differ "the number of frames of INPUT: no frames, 2" "$same a.npy --count-only" "$same moving.npy --count-only"
differ "INPUT: 1 given (a.npy), 2 given (a.npy a.npy)" "$same a.npy --count-only" "$same a.npy a.npy --count-only"
differ "--against: not given, 1 given (a.npy)" "$same a.npy --count-only" "$same a.npy --against a.npy --count-only"
differ "the content of --against" "$same $work/one/a.npy --against a.npy" "$same copy.npy --against a.npy"

# Options. Without the comparison most of these ranks would wait for ever.
differ "--count-only: not given, true" "$same a.npy" "$same copy.npy --count-only"
differ "--output: no.npy, no.csv" "$same a.npy --output no.npy" "$same copy.npy --output no.csv"
differ "--margin: 0.1, 0.2" "$same a.npy --margin 0.1 --count-only" "$same copy.npy --margin 0.2 --count-only"
differ "--events: true, not given" "$same a.npy --events --output no.csv" "$same copy.npy --output no.csv"
differ "the subcommand: detect, serve" "$same a.npy" "serve --engine mpi --listen unix:no.socket"
differ "--rank-timeout: 60000 ms, 7000 ms" "serve --engine mpi --listen unix:no.socket" \
    "serve --engine mpi --listen unix:no.socket --rank-timeout 7"

# Scenes of shapes: boxes may differ although the named files are equal, because a scene names other files.
for folder in one other; do
    size=$([ $folder = one ] && echo 1 || echo 2)
    printf 'v 0 0 0\nv %s 0 0\nv 0 1 0\nf 1 2 3\n' "$size" > $folder/shape.obj
    printf '{"shapes": {"s": {"type": "mesh", "file": "shape.obj"}}, "objects": [{"shape": "s"}, {"shape": "s"}]}' > $folder/scene.json
done
differ "the boxes of INPUT" "$same scene.json --count-only" "$same scene.json --count-only"

# Of a large file 1,024 blocks are compared, at both ends and between; with --verify all of it. CHANGE is the place of a changed byte.
"$program" generate uniform --objects 200000 --seed 1 --output one/large.npy --quiet
change() {
    cp one/large.npy other/large.npy
    python3 -c 'import sys
with open("other/large.npy", "r+b") as f:
    f.seek(int(sys.argv[1]), 0 if sys.argv[1][0] != "-" else 2)
    byte = f.read(1)[0]
    f.seek(-1, 1)
    f.write(bytes([byte ^ 1]))' "$1"
}
for place in 128 -1; do
    change $place
    differ "the content of input 1" "$same large.npy --count-only" "$same large.npy --count-only"
done
change 4200  # between the first two blocks
run_both "$same large.npy --count-only" "$same large.npy --count-only" > out.txt 2> errors.txt || fail "refused: $(cat errors.txt)"
differ "the content of input 1" "$same large.npy --count-only --verify" "$same large.npy --count-only --verify"
echo "ranks that differ are refused"

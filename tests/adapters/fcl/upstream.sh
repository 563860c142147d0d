#!/usr/bin/env bash
# Runs FCL's own tests of broad phases, with octopair's manager among the managers that they compare.
#
#     upstream.sh WORK ROOT LIBRARY COMPILER
#
# Gets Debian's source package of the installed FCL into the folder WORK, with a package list of its own there. Adds octopair's
# manager to the lists of managers in the tests, and compiles and runs the tests. Nothing else in the tests is changed. Without
# NDEBUG they use their small settings. LIBRARY is octopair's library. Exit status: 77 if the source cannot be had.
set -euo pipefail
work=$1 root=$2 library=$3 compiler=$4
tests="test_fcl_broadphase_collision_1 test_fcl_broadphase_collision_2 test_fcl_broadphase_distance"

skip() {
    echo "FCL's tests are left out: $1"
    exit 77
}

# Prints the folder with FCL's tests.
find_tests() {
    find "$work" -path '*/test/test_fcl_utility.cpp' -printf '%h\n' -quit 2> /dev/null
}

get_source() {
    local version keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    command -v apt-get > /dev/null || skip "there is no apt-get"
    version=$(dpkg-query -W -f '${source:Version}' libfcl-dev 2> /dev/null) || skip "libfcl-dev is not installed"
    [ -r "$keyring" ] || skip "Debian's keys are not installed"
    # shellcheck source=/dev/null
    local release=$(. /etc/os-release && echo "${VERSION_CODENAME:-stable}")
    mkdir -p "$work/lists/partial" "$work/cache/archives/partial"
    echo "deb-src [signed-by=$keyring] http://deb.debian.org/debian $release main" > "$work/sources.list"
    local options=(-q -o "Dir::Etc::sourcelist=$work/sources.list" -o Dir::Etc::sourceparts=/dev/null
                   -o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work/cache" -o APT::Sandbox::User=root
                   -o Acquire::http::Timeout=20 -o Acquire::Retries=1)
    timeout 120 apt-get "${options[@]}" update > "$work/apt.log" 2>&1 || skip "apt-get update failed, see $work/apt.log"
    (cd "$work" && timeout 120 apt-get "${options[@]}" source --download-only "fcl=$version") >> "$work/apt.log" 2>&1 ||
        skip "apt-get source failed, see $work/apt.log"
    tar -xzf "$work"/fcl_*.orig.tar.gz -C "$work"
}

# NAME: compiles a source file in the folder of octopair's copies.
compile() {
    "$compiler" -std=c++20 -w -I "$root/include" -I "$root/adapters/fcl/include" -I "$folder" -isystem /usr/include/eigen3 \
        -c "$work/$1.cpp" -o "$work/$1.o"
}

# NAME: adds octopair's manager after the first manager of each list.
add_manager() {
    local first='managers.push_back(new NaiveCollisionManager<S>());'
    sed -e "s|^ *${first}|&  managers.push_back(new octopair::fcl::BroadPhaseManager<S>());|" \
        -e 's|^#include "test_fcl_utility.h"|&\n#include <octopair/fcl/broad_phase_manager.hpp>|' "$folder/$1.cpp" > "$work/$1.cpp"
    grep -q 'octopair::fcl::BroadPhaseManager' "$work/$1.cpp" || { echo "$1 has no list of managers" && exit 1; }
}

mkdir -p "$work"
folder=$(find_tests)
[ -n "$folder" ] || get_source
folder=$(find_tests)
[ -n "$folder" ] || skip "the source package has no tests"
cp "$folder/test_fcl_utility.cpp" "$work"
for test in $tests; do add_manager "$test"; done
printf '%s\n' test_fcl_utility $tests | {
    export -f compile
    export compiler root folder work
    xargs -P 2 -I{} bash -c 'compile {}'
}
for test in $tests; do
    "$compiler" "$work/$test.o" "$work/test_fcl_utility.o" "$library" -lfcl -lccd -loctomap -loctomath -ltbb -lhwy -lgtest \
        -pthread -o "$work/$test"
    (cd "$work" && "./$test" --gtest_brief=1 > "$test.log" 2>&1) || { tail -40 "$work/$test.log" && exit 1; }
    grep -E '^\[' "$work/$test.log"
done
echo "FCL's tests accept octopair's manager"

#!/usr/bin/env bash
# Installs the Debian packages in a bare Debian 12, tests them there, and removes them.
#
#     debian.sh PACKAGES      the folder that scripts/package made
#
# 1. octopair alone, without a compiler: prints the time from apt install to the first pairs.
# 2. The readers: octopair reads IFC and STEP with their packages.
# 3. The tests of the packages (packaging/debian/tests) with autopkgtest: the README's C++, C and Python, ranks and the server.
# 4. The server under the options of its systemd unit, as the user octopair.
# 5. After their removal no file of the packages is left.
#
# Needs root and Debian's mirror. Without either, the status is 77: skipped.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
packages=$(realpath "$1")
[ "$(id -u)" = 0 ] || { echo "skipped: needs root" && exit 77; }

work=$(mktemp -d)
bare=$work/root
clean_up() {
    umount -R "$bare/dev" "$bare/proc" 2> /dev/null || true
    rm -rf --one-file-system "$work"
}
trap clean_up EXIT
fail() {
    echo "$1" >&2
    exit 1
}
in_root() { chroot "$bare" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
# Installs packages. Patterns of files are expanded in the root.
install() {
    in_root sh -c "apt-get install -y -qq --no-install-recommends $*" > "$work/apt.log" 2>&1 ||
        { tail -20 "$work/apt.log" && fail "apt-get install $*"; }
}
# Lists the files of octopair, without those that the package manager and this test keep.
list_files() { (cd "$bare" && find etc lib usr var/lib/octopair run -xdev -name '*octopair*' 2> /dev/null) || true; }

# The root is thrown away, so dpkg does not wait until files are on the disk.
mmdebstrap --quiet --variant=minbase --include=ca-certificates --dpkgopt=force-unsafe-io bookworm "$bare" > "$work/log" 2>&1 ||
    { cat "$work/log" && echo "skipped: cannot make a bare Debian" && exit 77; }
mount -t proc proc "$bare/proc"
mount --rbind /dev "$bare/dev" && mount --make-rslave "$bare/dev"
mkdir "$bare/debs"
cp "$packages"/*.deb "$bare/debs"
cp -r "$here/../../packaging/debian/tests" "$bare/debs/tests"
in_root apt-get update -qq
! in_root sh -c 'command -v cc || command -v python3' || fail "the root is not bare"

echo "1. octopair alone"
begin=$(date +%s.%N)
install /debs/octopair_*.deb /debs/liboctopair2_*.deb /debs/liboctopair-processes2_*.deb
in_root sh /debs/tests/program
awk -v from="$begin" -v to="$(date +%s.%N)" 'BEGIN { printf "from apt install to pairs: %.1f s\n", to - from }'
in_root sh -c 'test -f /usr/share/man/man1/octopair.1.gz && test -f /usr/share/bash-completion/completions/octopair'

echo "2. the readers"
PYTHONPATH=$here/../readers python3 -B - > "$bare/tmp/wall.ifc" << 'END'
from ifc_writer import IfcWriter

file = IfcWriter("IFC4")
file.element("IFCWALL", "Wall", file.represent([file.block((0, 0, 0), (4000, 200, 3000))]), "$,$")
print(file.text())
END
xz -dc "$here/../../examples/models/as1_pe_203.stp.xz" > "$bare/tmp/as1.stp"
install /debs/octopair-ifc_*.deb /debs/octopair-step_*.deb
# FILE READER COUNT: octopair reads this number of elements with this reader.
reads() {
    in_root octopair info "/tmp/$1" > "$work/info" || fail "octopair info $1"
    grep -q "read by $2$" "$work/info" && grep -q "$3 of $3 with geometry were read" "$work/info" ||
        { cat "$work/info" && fail "$1 is read wrongly"; }
}
reads wall.ifc octopair-ifc 1
reads as1.stp octopair-step 18

echo "3. the packages' own tests"
source=$(ls "$packages"/source/*.dsc)
# The tests run in the environment of this script, without its settings for compilers.
env -u CXX -u CMAKE_CXX_COMPILER_LAUNCHER autopkgtest "$source" "$bare"/debs/*.deb -- chroot "$bare" > "$work/autopkgtest.log" 2>&1 ||
    { sed -n '/: \[---/,/---\]/p' "$work/autopkgtest.log" && fail "autopkgtest failed"; }
sed -n '/ summary$/,$p' "$work/autopkgtest.log" > "$work/summary"
cat "$work/summary"
[ "$(grep -c ' PASS$' "$work/summary")" = "$(grep -c '^Tests:' "$bare/debs/tests/control")" ] || fail "a test of the packages did not run"

echo "4. the server's unit"
install /debs/octopair-server_*.deb /debs/octopair-doc_*.deb
unit=$bare/lib/systemd/system/octopair.service
sed 's|^ExecStart=[^ ]*|ExecStart=/bin/true|' "$unit" > "$work/octopair.service"
systemd-analyze security --offline=true --threshold=25 "$work/octopair.service" > "$work/security.log" ||
    { tail -1 "$work/security.log" && fail "the unit of the server is too open"; }
in_root sh -euc '
    install -d -o octopair -g octopair -m 700 /var/lib/octopair
    install -d -o octopair -g octopair /run/octopair
    command=$(sed -n "s/^ExecStart=//p" /lib/systemd/system/octopair.service)
    setpriv --reuid=octopair --regid=octopair --clear-groups --no-new-privs --bounding-set=-all sh -c "STATE_DIRECTORY=/var/lib/octopair exec $command" &
    server=$!
    octopair generate uniform --objects 1000 --seed 1 --output /tmp/boxes.npy
    for _ in $(seq 100); do octopair status --server 127.0.0.1:7788 > /dev/null 2>&1 && break || sleep 0.1; done
    octopair detect /tmp/boxes.npy --engine 127.0.0.1:7788 --count-only
    kill $server && wait $server
    rmdir /run/octopair'
in_root test -f /usr/share/doc/octopair/html/index.html

echo "5. removal"
[ "$(list_files | wc -l)" -gt 50 ] || fail "no files of the packages are found"
in_root apt-get purge -y -qq '*octopair*' > "$work/apt.log" 2>&1 || { tail -20 "$work/apt.log" && fail "apt-get purge"; }
left=$(list_files)
[ -z "$left" ] || fail "left after the removal: $left"
! in_root getent passwd octopair || fail "the user octopair is left"
echo "the packages work in a bare Debian and leave nothing"

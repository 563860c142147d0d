#!/usr/bin/env bash
# Makes the container image, and runs it: image_test.sh ROOT PROGRAM VERSION [FILE.deb...]
#
# PROGRAM: a program octopair outside of the image, which calls the server in the image. FILE.deb: arguments of scripts/image.
#
# Runs the image with buildah in a chroot, which needs no more rights than a build. Exit status 77 if Debian's mirror cannot be
# reached, or if this is not root. OCTOPAIR_IMAGE and SOURCE_DATE_EPOCH: an image to test instead, and its time.
set -euo pipefail
root=$1 program=$2 version=$3
shift 3
work=$(mktemp -d)
buildah=(buildah --storage-driver vfs --root "$work/storage" --runroot "$work/run")
container=

# Removes everything, and ends a server that still runs. Shows the server's log after a failure.
clean_up() {
    local status=$?
    [ $status = 0 ] || [ ! -f "$work/server.log" ] || tail -20 "$work/server.log"
    [ ! -f "$work/data/pid" ] || kill -KILL "$(cat "$work/data/pid")" 2> /dev/null || true
    [ -z "$container" ] || "${buildah[@]}" rm "$container" > /dev/null || true
    rm -rf "$work"
}
trap clean_up EXIT

fail() { echo "$*" >&2 && exit 1; }
skip() { echo "skipped: $*" && exit 77; }
[ "$(id -u)" = 0 ] || skip "not root"
/usr/lib/apt/apt-helper download-file http://deb.debian.org/debian/dists/stable/Release "$work/Release" > /dev/null 2>&1 ||
    skip "Debian's mirror cannot be reached"

# Runs a command in the container as its user, with the folders of the test mounted.
inside() {
    "${buildah[@]}" run --isolation chroot -v "$work/data:/data" -v "$work/sockets:/run/octopair" "$container" -- "$@"
}

# NAME: prints a value of the image's configuration.
configured() { "${buildah[@]}" inspect --type image --format "{{.OCIv1.$1}}" "$image"; }

# DESCRIPTION EXPECTED ACTUAL: fails unless both values are equal.
expect() { [ "$2" = "$3" ] || fail "$1: '$3', expected '$2'"; }

check_configuration() {
    local label
    expect entrypoint "[octopair]" "$(configured Config.Entrypoint)"
    expect user 10001:10001 "$(configured Config.User)"
    expect ports "map[7788:{}]" "$(configured Config.ExposedPorts)"
    expect volumes "map[/var/lib/octopair:{}]" "$(configured Config.Volumes)"
    expect time "$(date -u -d "@$SOURCE_DATE_EPOCH" '+%F %T +0000 UTC')" "$(configured Created)"
    for label in title:octopair version:"$version" licenses:BSD-3-Clause; do
        configured Config.Labels | grep -q "org.opencontainers.image.$label" || fail "no label $label"
    done
}

check_contents() {
    expect user 10001 "$(inside id -u)"
    [ -z "$(inside sh -c 'command -v gcc cc g++ c++ as ld make' || true)" ] || fail "the image has a compiler"
    inside sh -c 'test -x /usr/libexec/octopair/octopair-worker && test -f /usr/share/octopair/serve.toml' || fail "files are missing"
    ! inside sh -c 'touch /usr/x 2> /dev/null' || fail "the user can write to /usr"
    inside octopair info | grep -q "$version" || fail "octopair info has no version $version"
}

# Finds pairs of a mounted folder, and compares them with those of the program outside.
check_detect() {
    "$program" generate uniform --objects 20000 --seed 1 --output "$work/data/boxes.npy" --quiet
    "$program" detect "$work/data/boxes.npy" --output "$work/expected.npy" --quiet
    inside octopair detect boxes.npy --output local.npy --quiet
    inside octopair detect boxes.npy --engine processes --workers 2 --output processes.npy --quiet
    cmp "$work/expected.npy" "$work/data/local.npy"
    cmp "$work/expected.npy" "$work/data/processes.npy"
    expect "owner of the output" 10001 "$(stat -c %u "$work/data/local.npy")"
}

# Starts the server with the default arguments of the image, connects from outside, and stops the server with SIGTERM.
check_server() {
    local words
    words=$(configured Config.Entrypoint | tr -d '[]')\ $(configured Config.Cmd | tr -d '[]')
    inside sh -c "echo \$\$ > pid; exec $words" 2> "$work/server.log" &
    for _ in $(seq 300); do [ -S "$work/sockets/socket" ] && break || sleep 0.1; done
    "$program" detect "$work/data/boxes.npy" --engine "unix:$work/sockets/socket" --output "$work/remote.npy" --quiet
    cmp "$work/expected.npy" "$work/remote.npy"
    inside octopair status > /dev/null || fail "the health check fails"
    OCTOPAIR_SERVER="unix:$work/sockets/socket" "$program" submit "$work/data/boxes.npy" --quiet > "$work/id"
    [ -n "$(inside ls -A /var/lib/octopair)" ] || fail "the job is not in the state folder"
    kill -TERM "$(cat "$work/data/pid")"
    wait $! || fail "the server ends with status $?"
    rm "$work/data/pid"
    ! inside octopair status > /dev/null 2>&1 || fail "the health check succeeds without a server"
}

export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-1700000000}
mkdir "$work/data" "$work/sockets"
chown 10001:10001 "$work/data" "$work/sockets"
# The container's user must reach the mounted folders.
chmod 755 "$work"
file=${OCTOPAIR_IMAGE:-$work/image.tar}
[ -n "${OCTOPAIR_IMAGE:-}" ] || "$root/scripts/image" --output "$file" "$@"
image=$("${buildah[@]}" pull --quiet "oci-archive:$file")
container=$("${buildah[@]}" from --pull-never "$image")
check_configuration
check_contents
check_detect
check_server
echo "the image works; $(du -m "$file" | cut -f1) MB"

#!/usr/bin/env bash
# Runs a command with a server of its own: with_server.sh PROGRAM COMMAND [ARGUMENT...]     @ADDRESS@ becomes its address
set -euo pipefail
program=$1
shift
folder=$(mktemp -d)
trap 'kill "$server" 2> /dev/null || true; wait "$server" || true; rm -rf "$folder"' EXIT
address="unix:$folder/socket"
"$program" serve --listen "$address" 2> "$folder/log" &
server=$!
"${@//@ADDRESS@/$address}"

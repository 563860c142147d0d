#!/usr/bin/env bash
# Starts a server, runs a command, and stops the server. In the arguments, @ADDRESS@ stands for the server's address.
#
#     with_server.sh PROGRAM COMMAND [ARGUMENT...]
set -euo pipefail
program=$1
shift
folder=$(mktemp -d)
trap 'kill "$server" 2> /dev/null || true; wait "$server" || true; rm -rf "$folder"' EXIT
address="unix:$folder/socket"
"$program" serve --listen "$address" 2> "$folder/log" &
server=$!
"${@//@ADDRESS@/$address}"

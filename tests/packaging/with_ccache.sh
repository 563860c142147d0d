#!/usr/bin/env bash
# Runs a command that compiles octopair, through ccache if it is installed: with_ccache.sh COMMAND...
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"
compile_through_ccache
exec "$@"

#!/usr/bin/env bash
# Runs a command that makes packages, so that these take the objects of the preset `release` from ccache, if that is installed:
# release_objects.sh COMMAND...
#
# A package compiles with the distribution's options, which give other objects. So this script replaces them with those of the stage
# `packages` (tools/run_stages.py), which has debug information because abi.sh reads it. LDFLAGS=-s leaves it out of other packages than
# Debian's. With OCTOPAIR_TEST_FROM_SOURCE=1 this script changes nothing: the stage long-packages makes the packages as
# their users do.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"
compile_through_ccache
if [ "${OCTOPAIR_TEST_FROM_SOURCE:-}" != 1 ]; then
    export CXXFLAGS="-g -fno-var-tracking"
    export DEB_CFLAGS_SET='' DEB_CXXFLAGS_SET=$CXXFLAGS DEB_CPPFLAGS_SET=''
    export OCTOPAIR_CMAKE_OPTIONS=-DOCTOPAIR_WARNINGS_AS_ERRORS=ON
fi
exec "$@"

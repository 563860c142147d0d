#!/usr/bin/env bash
# Runs a command that makes packages, so that these take the objects of the preset `release` from ccache, if that is installed:
# release_objects.sh COMMAND...
#
# A package compiles with the distribution's options, which give other objects. Debian packages need debug information for abi.sh, so
# they compile with -g and without the other options. With OCTOPAIR_TEST_FROM_SOURCE=1 this script changes nothing: the stage long-packages
# makes the packages as their users do.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"
compile_through_ccache
if [ "${OCTOPAIR_TEST_FROM_SOURCE:-}" != 1 ]; then
    export DEB_CFLAGS_SET=-g DEB_CXXFLAGS_SET=-g DEB_CPPFLAGS_SET=''
    export OCTOPAIR_CMAKE_OPTIONS=-DOCTOPAIR_WARNINGS_AS_ERRORS=ON
fi
exec "$@"

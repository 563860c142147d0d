#!/usr/bin/env bash
# Runs a command that makes a package, so that it takes the objects of the preset `release` from ccache, if that is installed:
# release_objects.sh COMMAND...
#
# A package compiles with the distribution's options, which give other objects. With OCTOPAIR_TEST_FROM_SOURCE=1 this script changes
# nothing: the stage long-packages makes the packages as their users do.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../../scripts/common.sh"
compile_through_ccache
if [ "${OCTOPAIR_TEST_FROM_SOURCE:-}" != 1 ]; then
    export DEB_CFLAGS_SET='' DEB_CXXFLAGS_SET='' DEB_CPPFLAGS_SET='' DEB_BUILD_OPTIONS=noautodbgsym
    export OCTOPAIR_CMAKE_OPTIONS=-DOCTOPAIR_WARNINGS_AS_ERRORS=ON
fi
exec "$@"

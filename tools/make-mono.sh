#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs what compiles and runs the Unity client without Unity, about 30 MB, where it can.
set -eu

set --
command -v mcs >/dev/null || set -- "$@" mono-mcs
command -v mono >/dev/null || set -- "$@" mono-runtime
ls /usr/lib/cli/nunit.framework-2.6*/nunit.framework.dll >/dev/null 2>&1 || set -- "$@" libnunit-framework2.6.3-cil
# for ahead-of-time compilation
command -v as >/dev/null && command -v ld >/dev/null || set -- "$@" binutils
[ $# = 0 ] || sh tools/apt-install.sh "tests of the Unity client" "$@"

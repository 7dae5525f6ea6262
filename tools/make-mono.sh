#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs what runs the Unity client without Unity, about 30 MB, where it can.
set -eu

set --
command -v mono >/dev/null || set -- "$@" mono-runtime
for library in System System.Core System.Numerics System.Xml; do
    package=$(echo "libmono-$library" | tr 'A-Z.' 'a-z-')4.0-cil
    [ -e "/usr/lib/mono/4.5/$library.dll" ] || set -- "$@" "$package"
done
ls /usr/lib/cli/nunit.framework-2.6*/nunit.framework.dll >/dev/null 2>&1 || set -- "$@" libnunit-framework2.6.3-cil
# for ahead-of-time compilation
command -v as >/dev/null && command -v ld >/dev/null || set -- "$@" binutils
[ $# = 0 ] || sh tools/apt-install.sh "tests of the Unity client" "$@"

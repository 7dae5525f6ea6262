#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs what compiles and runs the Unity client without Unity, some 30 MB: as root, with apt. Otherwise says what is
# missing and goes on: the tests that need it are skipped.
set -eu

missing=
command -v mcs >/dev/null || missing="$missing mono-mcs"
command -v mono >/dev/null || missing="$missing mono-runtime"
ls /usr/lib/cli/nunit.framework-2.6*/nunit.framework.dll >/dev/null 2>&1 \
    || missing="$missing libnunit-framework2.6.3-cil"
# for ahead-of-time compilation
command -v as >/dev/null && command -v ld >/dev/null || missing="$missing binutils"
[ -n "$missing" ] || exit 0

if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
    echo "tests of the Unity client will be skipped; to run them: apt-get install$missing"
    exit 0
fi
echo "installing$missing ..."
export DEBIAN_FRONTEND=noninteractive
# word splitting is meant: one package each
# shellcheck disable=SC2086
apt-get install -y -qq --no-install-recommends $missing </dev/null >/dev/null 2>&1 || {
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends $missing </dev/null >/dev/null
} || echo "tests of the Unity client will be skipped: could not install$missing"

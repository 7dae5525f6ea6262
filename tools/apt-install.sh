#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# apt-install.sh WHAT PACKAGE...: installs Debian packages, as root. Otherwise says that WHAT will be skipped, with the command
# that helps, and succeeds: the tests that need the packages are skipped.
set -eu

what=$1
shift
if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
    echo "$what will be skipped. To run them: apt-get install $*"
    exit 0
fi
echo "installing $* ..."
export DEBIAN_FRONTEND=noninteractive
apt-get install -y -qq --no-install-recommends "$@" </dev/null >/dev/null 2>&1 || {
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends "$@" </dev/null >/dev/null
} || echo "$what will be skipped: could not install $*"

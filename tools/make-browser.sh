#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the browser that looks at the pages, 64 MB to download, where it can.
set -eu

[ -e /usr/lib/chromium/chromium-headless-shell ] || sh tools/apt-install.sh "tests of the pages" chromium-headless-shell

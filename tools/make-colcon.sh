#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# make-colcon.sh VENV: installs colcon into VENV/colcon, about 40 MB. Not into VENV, because it brings plugins of pytest.
set -eu
venv=$(cd "$1" && pwd)

[ -e "$venv/colcon/.ready" ] && exit 0
rm -rf "$venv/colcon"
echo "installing colcon ..."
# setuptools as on Ubuntu 24.04
sh "$(dirname "$0")/pip-install.sh" "$venv/bin/python" --target "$venv/colcon" \
    'colcon-core>=0.18' 'colcon-ros>=0.5' 'setuptools==68.1.2'
touch "$venv/colcon/.ready"

#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Say what to do where a folder of the source tree cannot be written: check-writable.sh DIRECTORY
set -eu
directory=$1
probe=$directory/.writable

if mkdir -p "$directory" 2>/dev/null && (: >"$probe") 2>/dev/null; then
    rm -f "$probe"
    rmdir "$directory" 2>/dev/null || true # as it was, if it was not there
    exit 0
fi
echo "cannot write $directory in $(pwd): the tree is read-only, or belongs to another user." >&2
echo "Copy it to your home directory, and go on there:" >&2
echo "  cp -r '$(pwd)' ~/ros2-json-gateway && cd ~/ros2-json-gateway" >&2
exit 1

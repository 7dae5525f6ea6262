#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Install packages, with a line for each large one, and in plain words without a network: pip-install.sh PYTHON ARGUMENTS_OF_PIP
set -eu
python=$1
shift
log=$(mktemp)
trap 'rm -f "$log" "$log".*' EXIT

# pip's own 5 take half a minute where there is no network. These are pip's, and those of the pip that builds
export PIP_RETRIES="${PIP_RETRIES:-1}"

# a pipe has the exit code of its last command
{ "$python" -m pip install --disable-pip-version-check --no-input --log "$log" "$@" 2>"$log.errors" || echo $? >"$log.failed"; } |
    sed -nuE 's/^ *(Downloading|Using cached) ([^ ]+) \(([0-9.]+ MB)\).*/  \2, \3/p; s/^Installing collected packages.*/  unpacking .../p'
[ -e "$log.failed" ] || exit 0

if grep -qE "connection broken|connection error|Max retries exceeded|timed out" "$log"; then
    echo "no network: pip cannot reach its package index, so nothing is installed." >&2
    echo "Connect this machine, or name an index or a proxy in PIP_INDEX_URL or HTTPS_PROXY. Then run make again." >&2
else
    cat "$log.errors" >&2
fi
exit 1

#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the load balancers of the fleet example, 7 MB, where it can.
set -eu

for each in haproxy nginx; do
    command -v $each >/dev/null || sh tools/apt-install.sh "the test of the fleet with $each" $each
done

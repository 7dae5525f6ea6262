#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs the load balancer of the fleet example, 5 MB, where it can.
set -eu

command -v haproxy >/dev/null || sh tools/apt-install.sh "the test of the fleet" haproxy

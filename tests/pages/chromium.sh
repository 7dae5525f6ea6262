#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Debian's Chromium. As root it would raise the priority of what draws its pages, and take a busy
# machine's processors from the robot and the gateway that the pages talk to.
set -- /usr/lib/chromium/chromium-headless-shell "$@"
if setpriv --bounding-set=-sys_nice true 2> /dev/null; then
    set -- setpriv --bounding-set=-sys_nice --inh-caps=-sys_nice "$@"
fi
exec "$@"

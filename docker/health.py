# SPDX-License-Identifier: Apache-2.0
"""The health check of the images: asks the gateway where its environment says it listens."""

import http.client
import os
import sys

host = os.environ.get("ROS2_GATEWAY_HOST", "127.0.0.1")
host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)  # noqa: S104  # asked, not bound
port = int(os.environ.get("ROS2_GATEWAY_PORT", "9090"))
gateway = http.client.HTTPConnection(host, port, timeout=2)
gateway.request("GET", "/healthz")
sys.exit(gateway.getresponse().status != http.HTTPStatus.OK)

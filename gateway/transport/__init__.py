# SPDX-License-Identifier: Apache-2.0
"""The WebSocket server. Only it and `gateway.cli.remote_connection` import websockets.

The map is docs/contributing/architecture.md.
"""

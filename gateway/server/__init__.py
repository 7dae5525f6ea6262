# SPDX-License-Identifier: Apache-2.0
"""The WebSocket server. The only importer of websockets beside `gateway.cli.remote_connection`.

The map is docs/contributing/architecture.md.
"""

# SPDX-License-Identifier: Apache-2.0
"""The WebSocket server; the only importer of websockets.

The map is docs/architecture.md.
"""

# SPDX-License-Identifier: Apache-2.0
"""ROS 2 topics, services, actions and parameters as JSON over a WebSocket, and back.

docs/contributing/architecture.md is the map: the rooms, the threads, and the ways through the code.
"""

# SPDX-License-Identifier: Apache-2.0
"""ROS 2 topics as JSON frames over a WebSocket, and back."""

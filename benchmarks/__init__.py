# SPDX-License-Identifier: Apache-2.0
"""The cost of the path from DDS to a socket, next to a bare rclpy subscriber in the same run."""

# SPDX-License-Identifier: Apache-2.0
"""ROS 2 through rclpy; the only importer of rclpy beside the simulated robot."""

# SPDX-License-Identifier: Apache-2.0
"""A source that plays recordings: MCAP, rosbag2, and ROS 1 bags. It imports no rclpy."""

# SPDX-License-Identifier: Apache-2.0
"""Topics: one ROS subscription for many subscribers, and publishing by clients."""

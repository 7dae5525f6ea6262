# SPDX-License-Identifier: Apache-2.0
"""A simulated robot and a mock system, as real ROS nodes."""

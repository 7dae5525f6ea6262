# SPDX-License-Identifier: Apache-2.0
"""ROS 2 through Zenoh, as rmw_zenoh speaks it, without ROS on this machine."""

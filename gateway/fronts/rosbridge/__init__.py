# SPDX-License-Identifier: Apache-2.0
"""The rosbridge protocol as pure functions of bytes and time: no sockets, no clocks, no ROS.

The map is docs/contributing/architecture.md.
"""

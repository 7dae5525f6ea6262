# SPDX-License-Identifier: Apache-2.0
"""Between the clients' sessions and ROS: one subscription serves many, one frame many sockets.

The map is docs/contributing/architecture.md.
"""

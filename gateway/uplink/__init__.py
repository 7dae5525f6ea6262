# SPDX-License-Identifier: Apache-2.0
"""The uplink: a client of the core that offers the robot to relays, through a Zenoh router.

Everything is in one namespace for each robot, and reads as a robot with rmw_zenoh. So a relay is a
gateway with `gateway.sources.zenoh`.
"""

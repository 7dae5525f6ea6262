# SPDX-License-Identifier: Apache-2.0
"""Introspection: the gateway itself, types, the ROS graph and parameters of nodes."""

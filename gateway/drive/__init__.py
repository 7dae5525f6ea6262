# SPDX-License-Identifier: Apache-2.0
"""Moving a robot: which commands go out, and when it is stopped.

Pure computation: commands and times come in, effects come out as data. No clock, socket or ROS.

The map is docs/contributing/architecture.md. docs/explanation/safety.md explains the rules.
"""

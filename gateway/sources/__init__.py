# SPDX-License-Identifier: Apache-2.0
"""Sources of a robot's graph, topics, services and actions. No source knows another."""

# SPDX-License-Identifier: Apache-2.0
"""The relay: one port, one core for each robot behind a Zenoh router."""

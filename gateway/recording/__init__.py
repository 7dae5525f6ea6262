# SPDX-License-Identifier: Apache-2.0
"""Recordings: what the robot said and what operators did, as MCAP files.

The recorder is a client of the core without a socket. A thread writes what it gets.
"""

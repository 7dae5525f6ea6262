# SPDX-License-Identifier: Apache-2.0
"""Actions: goals that clients send, and actions that clients provide."""

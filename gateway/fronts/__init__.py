# SPDX-License-Identifier: Apache-2.0
"""The protocols that clients speak, and the pages. No front knows another."""

# SPDX-License-Identifier: Apache-2.0
"""CDR to values, JSON and pictures, and back. Pure computation.

The map is docs/contributing/architecture.md.
"""

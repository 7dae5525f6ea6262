# SPDX-License-Identifier: Apache-2.0
"""What can be configured, and where its values come from.

The map is docs/architecture.md.
"""

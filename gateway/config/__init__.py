# SPDX-License-Identifier: Apache-2.0
"""The configuration, and the sources of its values.

docs/contributing/architecture.md describes the packages.
"""

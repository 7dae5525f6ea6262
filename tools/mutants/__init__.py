# SPDX-License-Identifier: Apache-2.0
"""Breaks lines of the code on purpose, and sees whether the tests notice.

See docs/contributing/mutants.md.
"""

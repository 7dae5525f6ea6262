# SPDX-License-Identifier: Apache-2.0
"""Breaks lines of the code on purpose, and sees whether the tests notice; see docs/mutants.md."""

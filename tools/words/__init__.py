# SPDX-License-Identifier: Apache-2.0
"""Checks of the words in this repository: where text is, and the rules that it follows."""

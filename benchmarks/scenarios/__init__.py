# SPDX-License-Identifier: Apache-2.0
"""The scenarios: each module measures one thing, prints its table and returns its figures."""

# SPDX-License-Identifier: Apache-2.0
"""What is measured: each module measures one thing, prints its table and returns its figures."""

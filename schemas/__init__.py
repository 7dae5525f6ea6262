# SPDX-License-Identifier: Apache-2.0
"""The list of message types, the files generated from it, and the definitions behind them."""

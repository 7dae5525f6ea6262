# SPDX-License-Identifier: Apache-2.0
"""Hours of a robot's life in a row: a load, disturbances, and what must hold in spite of them."""

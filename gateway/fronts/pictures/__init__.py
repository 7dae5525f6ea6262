# SPDX-License-Identifier: Apache-2.0
"""Images of topics by plain HTTP: `/stream` and `/snapshot`."""

# SPDX-License-Identifier: Apache-2.0
"""Services: called by clients, and provided by clients."""

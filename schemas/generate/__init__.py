# SPDX-License-Identifier: Apache-2.0
"""The generator: from the list of message types and the installed definitions to files in the tree.

Every language is one module with one function, from a `Catalogue` to texts by path. See
`schemas.generate.writers` for the list.
"""

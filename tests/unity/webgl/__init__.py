# SPDX-License-Identifier: Apache-2.0
"""The WebGL transport: its JavaScript under Node, its C# under Mono, and both together."""

# SPDX-License-Identifier: Apache-2.0
"""The Unity packages' prefabs, materials and scenes, in Unity's text format."""

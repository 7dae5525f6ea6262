# SPDX-License-Identifier: Apache-2.0
"""Conversations with every byte that each client gets, one per file.

A file is script and recording in one. `python -m tests.fronts.rosbridge.wire_fixtures --write`
carries out all lines except those with ``<``, and writes these again:

- ``A> TEXT``: client A sends a text. ``A>cbor JSON`` sends it as CBOR, and ``A>hex BYTES`` bytes.
- ``! VERB ...``: something happens outside. Each verb is a method of `Stage`.
- ``A< TEXT``: a text frame to client A. A newline in it is written as ``␊``.
- ``A<cbor VALUE = BYTES``: a binary frame to client A.
- ``/name< ...``: a message, request or goal that others in ROS get, or the answer to theirs.
- ``<IMAGE sha256:...>`` is in the place of what OpenCV has encoded. With another version of OpenCV
  than the one in the file, only the rest is compared.
"""

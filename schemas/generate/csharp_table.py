# SPDX-License-Identifier: Apache-2.0
"""Write the C# class that knows the list of message types by name, and none of their classes."""

from collections.abc import Iterable
from typing import Final

from schemas.generate.catalogue import GENERATED, Catalogue
from schemas.generate.csharp_text import head

_SOURCE: Final = """\
// SPDX-License-Identifier: Apache-2.0
%(head)s
namespace Ros2Gateway.Messages
{
    /// <summary>
    /// The types whose classes come with the package, and the numbers of the message table.
    /// It refers to no class, so that a build has only those that are used.
    /// </summary>
    internal static class MessageTable
    {
        /// <summary>The types of messages, sorted.</summary>
        internal static readonly string[] Names =
        {
%(names)s
        };

        /// <summary>Returns the type of a number; null if the table has not that number.</summary>
        internal static string OfNumber(string number) => number switch
        {
%(numbers)s
            _ => null,
        };
    }
}
"""


def table_source(catalogue: Catalogue, names: Iterable[str]) -> str:
    """Return the text of ``MessageTable.cs``, with the *names* of the types that have classes."""
    numbers = [f'            "{row.number}" => "{row.name}",' for row in catalogue.rows]
    return _SOURCE % {
        "head": head(GENERATED),
        "names": "\n".join(f'            "{name}",' for name in sorted(names)),
        "numbers": "\n".join(numbers),
    }

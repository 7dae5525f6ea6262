# SPDX-License-Identifier: Apache-2.0
"""Write the C# class that knows the list of message types, and makes a message of each.

It names every class, so that those that are used only by name are in a build with it.
"""

from typing import Final

from schemas.generate.catalogue import GENERATED, Catalogue
from schemas.generate.csharp_text import ClassNames, head

_SOURCE: Final = """\
// SPDX-License-Identifier: Apache-2.0
%(head)s
namespace Ros2Gateway.Messages
{
    /// <summary>
    /// The classes that are generated with the package, and the numbers of the message table.
    /// <see cref="Create"/> alone refers to the classes: a build in which nobody calls it has
    /// those that are used.
    /// </summary>
    internal static class MessageTable
    {
        /// <summary>The types of messages, sorted.</summary>
        internal static readonly string[] Names =
        {
%(names)s
        };

        /// <summary>Makes a message, or a part of a service or an action; or null.</summary>
        internal static IMessage Create(string type)
        {
            switch (type)
            {
%(cases)s
                default:
                    return null;
            }
        }

        /// <summary>Returns the type of a number; null if the table has not that number.</summary>
        internal static string OfNumber(string number)
        {
            switch (number)
            {
%(numbers)s
                default:
                    return null;
            }
        }
    }
}
"""


def table_source(catalogue: Catalogue) -> str:
    """Return the text of ``MessageTable.cs``."""
    names = ClassNames("")  # the file is in no package's name space
    messages = sorted(catalogue.definitions)
    parts = sorted(part.name for part in catalogue.parts())
    inner = " " * 16
    cases = [f'case "{name}":\n    return new {names[name]}();' for name in [*messages, *parts]]
    numbers = [f'case "{row.number}":\n    return "{row.name}";' for row in catalogue.rows]
    return _SOURCE % {
        "head": head(GENERATED),
        "names": "\n".join(f'            "{name}",' for name in messages),
        "cases": "\n".join(inner + case.replace("\n", f"\n{inner}") for case in cases),
        "numbers": "\n".join(inner + case.replace("\n", f"\n{inner}") for case in numbers),
    }

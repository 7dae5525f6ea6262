# SPDX-License-Identifier: Apache-2.0
"""Write the C# class that makes a message of any type by name or number.

It names every class, so that classes used only by name are not stripped.
"""

from typing import Final

from schemas.generate.catalogue import GENERATED, Catalogue
from schemas.generate.csharp_text import ClassNames, head

_SOURCE: Final = """\
// SPDX-License-Identifier: Apache-2.0
%(head)s
using System;
using System.Collections.Generic;

namespace Ros2Gateway.Messages
{
    /// <summary>
    /// All generated messages, and parts of services and actions, by the name of their type; those
    /// of the message table by its numbers too. It refers to every class, so that managed stripping
    /// keeps them.
    /// </summary>
    public static class MessageCatalogue
    {
        private static readonly string[] Names =
        {
%(names)s
        };

        /// <summary>
        /// The types of messages as <c>pkg/msg/Name</c>, sorted; parts of services and actions,
        /// which no topic carries, are not among them.
        /// </summary>
        public static IReadOnlyList<string> Types
        {
            get { return Array.AsReadOnly(Names); }
        }

        /// <summary>Makes a message with the defaults of its definition.</summary>
        /// <param name="typeOrNumber"><c>pkg/msg/Name</c>, <c>pkg/Name</c>, a number of the message
        /// table as text, or a part: <c>pkg/srv/Name_Request</c>.</param>
        /// <returns>Null if there is no class for it.</returns>
        public static IMessage Create(string typeOrNumber)
        {
            string type = Resolve(typeOrNumber);
            switch (type)
            {
%(cases)s
                default:
                    return null;
            }
        }

        /// <summary>
        /// Returns the full name of a type for what <see cref="Create"/> takes, also of an unknown
        /// type; null for a number that the table has not.
        /// </summary>
        public static string Resolve(string typeOrNumber)
        {
            if (string.IsNullOrEmpty(typeOrNumber))
            {
                return null;
            }
            if (typeOrNumber[0] >= '0' && typeOrNumber[0] <= '9')
            {
                return OfNumber(typeOrNumber);
            }
            int slash = typeOrNumber.IndexOf('/');
            bool isShort = slash > 0 && slash == typeOrNumber.LastIndexOf('/');
            return isShort ? typeOrNumber.Insert(slash, "/msg") : typeOrNumber;
        }

        private static string OfNumber(string number)
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


def catalogue_source(catalogue: Catalogue) -> str:
    """Return the text of ``MessageCatalogue.cs``."""
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

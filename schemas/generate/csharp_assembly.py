# SPDX-License-Identifier: Apache-2.0
"""A Unity assembly of generated C# classes, which the package's components and menus know."""

import json
from collections.abc import Iterable
from typing import Final

from schemas.generate.csharp_text import ClassNames

# Unity keeps no mark in such a file, and its owner may want other references: it is written once.
DEFINITIONS: Final = "*.asmdef"

REFERENCES: Final = ["Ros2Gateway.Json", "Ros2Gateway.Messages"]

_REGISTRATION: Final = """\
%(top)s
using UnityEngine;
using UnityEngine.Scripting;

// A scene names types by text: a build has these classes even if no script mentions them.
[assembly: AlwaysLinkAssembly]

namespace Ros2Gateway.Messages
{
    /// <summary>Makes the classes beside it known to components and to the editor.</summary>
    internal static class MessageRegistration
    {
#if UNITY_EDITOR
        [UnityEditor.InitializeOnLoadMethod]
#endif
        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.BeforeSceneLoad)]
        private static void Register()
        {
%(calls)s
        }
    }
}
"""


def assembly_definition(name: str) -> dict[str, str]:
    """Return the file of an assembly that refers to the package's classes and to Unity."""
    content = {"name": name, "references": REFERENCES, "autoReferenced": True}
    return {f"{name}.asmdef": json.dumps(content, indent=4) + "\n"}


def registration(names: Iterable[str], top: str) -> dict[str, str]:
    """Return the file that registers the classes of some messages, below the comment *top*."""
    classes = ClassNames("")  # the file is in no package's name space
    made = (classes[name] for name in names)
    calls = "\n".join(
        f"{' ' * 12}MessageCatalogue.Register({one}.Type, () => new {one}());" for one in made
    )
    return {"MessageRegistration.cs": _REGISTRATION % {"top": top, "calls": calls}}

# SPDX-License-Identifier: Apache-2.0
"""Compile the driver: ``bootstrap.py DOTNET ROSLYN OUT.dll SOURCE...``.

A compiler written in C# needs a compiler first. So Python loads .NET, and calls Roslyn in it.
"""

import sys
from pathlib import Path

from pythonnet import load

# newer than those of .NET, so they need a separate context: a library after those it needs
_NEWER = ("System.Collections.Immutable", "System.Reflection.Metadata")
_COMPILER = ("Microsoft.CodeAnalysis", "Microsoft.CodeAnalysis.CSharp")


def main() -> None:
    """Compile. End with 1 and its words if the compiler refuses."""
    dotnet, roslyn, out, *sources = map(Path, sys.argv[1:])
    load("coreclr", runtime_config=str(out.with_suffix(".runtimeconfig.json")), dotnet_root=dotnet)
    import System
    from System.Runtime.Loader import AssemblyLoadContext

    context = AssemblyLoadContext("roslyn", False)
    for name in ("System.Runtime.CompilerServices.Unsafe", *_NEWER, *_COMPILER):
        context.LoadFromAssemblyPath(str(roslyn / f"{name}.dll"))
    import Microsoft.CodeAnalysis as Analysis
    from Microsoft.CodeAnalysis import CSharp

    (framework,) = (dotnet / "shared/Microsoft.NETCore.App").iterdir()
    paths = [p for p in framework.glob("System*.dll") if "Native" not in p.name]
    paths = [*(p for p in paths if p.stem not in _NEWER), framework / "netstandard.dll"]
    paths += [roslyn / f"{name}.dll" for name in (*_NEWER, *_COMPILER)]
    compilation = CSharp.CSharpCompilation.Create(
        out.stem,
        System.Array[Analysis.SyntaxTree](
            [CSharp.CSharpSyntaxTree.ParseText(s.read_text(), path=str(s)) for s in sources]
        ),
        System.Array[Analysis.MetadataReference](
            [Analysis.MetadataReference.CreateFromFile(str(path)) for path in paths]
        ),
        CSharp.CSharpCompilationOptions(Analysis.OutputKind.ConsoleApplication),
    )
    stream = System.IO.File.Create(str(out))
    result = compilation.Emit(stream)
    stream.Close()
    if not result.Success:
        sys.exit("\n".join(str(diagnostic) for diagnostic in result.Diagnostics))


if __name__ == "__main__":
    main()

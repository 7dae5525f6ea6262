// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Concurrent;
using System.Collections.Generic;
using System.Collections.Immutable;
using System.IO;
using System.Linq;
using System.Text;
using System.Text.Json;
using Microsoft.CodeAnalysis;
using Microsoft.CodeAnalysis.CSharp;
using Microsoft.CodeAnalysis.Emit;

namespace Ros2Gateway.Tests.Roslyn
{
    /// <summary>
    /// Compiles assemblies with Roslyn as Unity 2021.3 does, C# 9, warnings being errors. It reads a request per line, as JSON,
    /// and answers each with a line: what the compiler says. Files and libraries that were read once stay in memory.
    /// </summary>
    internal static class Program
    {
        private static readonly ConcurrentDictionary<string, MetadataReference> Libraries = new();
        private static readonly ConcurrentDictionary<(string, string), SyntaxTree> Trees = new();

        // 1701, 1702: of a library made for another version of the framework, which csc leaves out as well.
        // 1573: a parameter's meaning may be in the summary
        private static readonly string[] Suppressed = { "CS1573", "CS1701", "CS1702" };

        private static void Main()
        {
            string line;
            while ((line = Console.In.ReadLine()) != null)
            {
                Request request = JsonSerializer.Deserialize<Request>(line);
                Console.WriteLine(JsonSerializer.Serialize(Compile(request).Select(one => one.ToString())));
            }
        }

        private static IEnumerable<Diagnostic> Compile(Request request)
        {
            CSharpCompilation compilation = CSharpCompilation.Create(
                Path.GetFileNameWithoutExtension(request.Out),
                request.Sources.AsParallel().AsOrdered().Select(source => Parsed(source, request.Defines)).ToArray(),
                request.References.Select(path => Libraries.GetOrAdd(path, one => MetadataReference.CreateFromFile(one))),
                new CSharpCompilationOptions(
                    request.Out.EndsWith(".exe") ? OutputKind.ConsoleApplication : OutputKind.DynamicallyLinkedLibrary,
                    optimizationLevel: OptimizationLevel.Release,
                    deterministic: true,
                    generalDiagnosticOption: ReportDiagnostic.Error,
                    specificDiagnosticOptions: Suppressed.Concat(request.Suppressed)
                        .ToDictionary(code => code, _ => ReportDiagnostic.Suppress)));
            using MemoryStream program = new(), symbols = new();
            EmitResult result = compilation.Emit(
                program, symbols, options: new EmitOptions(debugInformationFormat: DebugInformationFormat.PortablePdb));
            if (result.Success)
            {
                File.WriteAllBytes(request.Out, program.ToArray());
                File.WriteAllBytes(Path.ChangeExtension(request.Out, ".pdb"), symbols.ToArray());
            }
            IEnumerable<Diagnostic> errors = result.Diagnostics.Where(one => one.Severity == DiagnosticSeverity.Error);
            return request.Style == "" ? errors : errors.Concat(Style.Check(compilation, request.Style));
        }

        // A file without conditions is the same for every target.
        private static SyntaxTree Parsed(string path, string[] defines)
        {
            string text = File.ReadAllText(path);
            string[] symbols = text.Contains("#if") ? defines : Array.Empty<string>();
            // Diagnose: a cref that leads nowhere is a warning.
            return Trees.GetOrAdd((path + "\n" + text, string.Join(" ", symbols)), _ => CSharpSyntaxTree.ParseText(
                text,
                new CSharpParseOptions(
                    LanguageVersion.CSharp9, DocumentationMode.Diagnose, SourceCodeKind.Regular, symbols),
                path,
                Encoding.UTF8));
        }

        private sealed class Request
        {
            /// <summary>The file to write, with its symbols next to it.</summary>
            public string Out { get; set; }

            public string[] Sources { get; set; }
            public string[] Defines { get; set; }
            public string[] References { get; set; }
            public string[] Suppressed { get; set; }

            /// <summary>An .editorconfig to check against. Empty for none.</summary>
            public string Style { get; set; }
        }
    }
}

// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Collections.Immutable;
using System.IO;
using System.Text;
using Microsoft.CodeAnalysis;
using Microsoft.CodeAnalysis.CSharp;

namespace Ros2Gateway.Tests.Roslyn
{
    /// <summary>
    /// Has Roslyn check assemblies as Unity 2021.3 has it compile them, C# 9, and prints what it says, warnings too. Emits
    /// nothing. Reads lines of a word and a value: an assembly begins with its name, a reference is an earlier one.
    /// </summary>
    internal static class Program
    {
        private static readonly Dictionary<string, MetadataReference> Checked = new Dictionary<string, MetadataReference>();
        private static readonly List<MetadataReference> Framework = new List<MetadataReference>();

        private static int Main()
        {
            foreach (string library in Directory.GetFiles(
                Path.GetDirectoryName(typeof(object).Assembly.Location), "*.dll"))
            {
                if (IsManaged(library))
                {
                    Framework.Add(MetadataReference.CreateFromFile(library));
                }
            }
            Description one = null;
            string line;
            while ((line = Console.In.ReadLine()) != null)
            {
                int space = line.IndexOf(' ');
                string value = line.Substring(space + 1);
                switch (line.Substring(0, space))
                {
                    case "assembly":
                        Check(one);
                        one = new Description { Name = value };
                        break;
                    case "source":
                        one.Sources.Add(value);
                        break;
                    case "define":
                        one.Defines.Add(value);
                        break;
                    case "reference":
                        one.References.Add(Checked[value]);
                        break;
                    case "library":
                        one.References.Add(MetadataReference.CreateFromFile(value));
                        break;
                    case "suppress":
                        one.Diagnostics[value] = ReportDiagnostic.Suppress;
                        break;
                    default:
                        throw new InvalidOperationException("unknown line: " + line);
                }
            }
            Check(one);
            return 0;
        }

        private static bool IsManaged(string library)
        {
            try
            {
                System.Reflection.AssemblyName.GetAssemblyName(library);
                return true;
            }
            catch (BadImageFormatException)
            {
                return false;
            }
        }

        private static void Check(Description one)
        {
            if (one == null)
            {
                return;
            }
            // Diagnose: a cref that leads nowhere is a warning.
            CSharpParseOptions parsing = new CSharpParseOptions(
                LanguageVersion.CSharp9, DocumentationMode.Diagnose, SourceCodeKind.Regular, one.Defines);
            List<SyntaxTree> trees = new List<SyntaxTree>();
            foreach (string source in one.Sources)
            {
                trees.Add(CSharpSyntaxTree.ParseText(File.ReadAllText(source), parsing, source, Encoding.UTF8));
            }
            one.References.AddRange(Framework);
            CSharpCompilation compilation = CSharpCompilation.Create(
                one.Name, trees, one.References, new CSharpCompilationOptions(OutputKind.DynamicallyLinkedLibrary)
                    .WithGeneralDiagnosticOption(ReportDiagnostic.Error)
                    .WithSpecificDiagnosticOptions(one.Diagnostics));
            ImmutableArray<Diagnostic> diagnostics = compilation.GetDiagnostics();
            foreach (Diagnostic diagnostic in diagnostics)
            {
                if (diagnostic.Severity == DiagnosticSeverity.Error)
                {
                    Console.WriteLine(one.Name + ": " + diagnostic);
                }
            }
            Checked[one.Name] = compilation.ToMetadataReference();
        }

        private sealed class Description
        {
            internal string Name;
            internal readonly List<string> Sources = new List<string>();
            internal readonly List<string> Defines = new List<string>();
            internal readonly List<MetadataReference> References = new List<MetadataReference>();

            // 1701, 1702: of a library made for another version of the framework, which csc leaves out as well.
            // 1573, 1591: of what has no comment, which is checked elsewhere
            internal readonly Dictionary<string, ReportDiagnostic> Diagnostics = new Dictionary<string, ReportDiagnostic>
            {
                { "CS1573", ReportDiagnostic.Suppress },
                { "CS1591", ReportDiagnostic.Suppress },
                { "CS1701", ReportDiagnostic.Suppress },
                { "CS1702", ReportDiagnostic.Suppress },
            };
        }
    }
}

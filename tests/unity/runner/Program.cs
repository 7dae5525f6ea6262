// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.IO;
using System.Reflection;
using UnityEngine.Stage;

namespace Ros2Gateway.Runner
{
    /// <summary>Runs the NUnit tests of an assembly as Unity's Test Framework does, on the main thread, in
    /// its player loop.</summary>
    /// <remarks><c>runner TESTS.dll [PART-OF-A-NAME]</c> prints a line per test and exits by the
    /// result. <c>--List</c> prints the names as JSON. <c>--Serve</c> runs the tests that it reads.</remarks>
    public static class Program
    {
        private const double TestTimeoutS = 240;  // a deadlock takes longer, and a busy machine does not

        public static int Main(string[] arguments)
        {
            if (arguments.Length == 0)
            {
                Console.Error.WriteLine("usage: runner [--list | --serve] TESTS.dll [PART-OF-A-NAME]");
                return 2;
            }
            TextWriter output = Console.Out;
            bool list = arguments[0] == "--list";
            bool serve = arguments[0] == "--serve";
            string path = arguments[list || serve ? 1 : 0];
            IList<TestCase> tests = TestFinder.Find(Assembly.LoadFrom(path));
            PlayerLoop.Start();
            if (list)
            {
                foreach (TestCase test in tests)
                {
                    output.WriteLine(Report.Listed(test));
                }
                return 0;
            }
            using (var watchdog = new Watchdog(TestTimeoutS, output))
            {
                var execution = new TestExecution(watchdog);
                return serve ? Serve(tests, execution, output)
                    : RunAll(tests, execution, arguments.Length > 1 ? arguments[1] : "", output);
            }
        }

        private static int Serve(IEnumerable<TestCase> tests, TestExecution execution, TextWriter output)
        {
            var byName = new Dictionary<string, TestCase>();
            foreach (TestCase test in tests)
            {
                byName[test.Name] = test;
            }
            for (string name = Console.In.ReadLine(); name != null; name = Console.In.ReadLine())
            {
                TestCase test;
                TestResult result = byName.TryGetValue(name, out test)
                    ? execution.Run(test)
                    : new TestResult(name, Outcome.Failed, "no such test");
                output.WriteLine(Report.Line(result));
                output.Flush();
            }
            PlayerLoop.Quit();
            return 0;
        }

        private static int RunAll(IEnumerable<TestCase> tests, TestExecution execution, string part,
            TextWriter output)
        {
            var counts = new int[3];
            foreach (TestCase test in tests)
            {
                if (test.Name.IndexOf(part, StringComparison.OrdinalIgnoreCase) < 0)
                {
                    continue;
                }
                TestResult result = execution.Run(test);
                counts[(int)result.Outcome]++;
                output.WriteLine(Report.Words(result));
            }
            PlayerLoop.Quit();
            output.WriteLine("{0} passed, {1} failed, {2} skipped", counts[0], counts[1], counts[2]);
            return counts[(int)Outcome.Failed] == 0 ? 0 : 1;
        }
    }
}

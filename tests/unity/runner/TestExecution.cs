// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections;
using System.Collections.Generic;
using System.Diagnostics;
using System.IO;
using System.Linq;
using System.Reflection;
using NUnit.Framework;
using UnityEngine.Stage;
using UnityEngine.TestTools;

namespace Ros2Gateway.Runner
{
    /// <summary>Runs one test after the other, each with its SetUp and TearDown.</summary>
    public sealed class TestExecution
    {
        private const BindingFlags Members =
            BindingFlags.Instance | BindingFlags.Static | BindingFlags.Public | BindingFlags.NonPublic;

        private readonly Watchdog _watchdog;

        public TestExecution(Watchdog watchdog)
        {
            _watchdog = watchdog;
        }

        public TestResult Run(TestCase test)
        {
            if (test.SkipReason != null)
            {
                return new TestResult(test.Name, Outcome.Skipped, test.SkipReason);
            }
            TextWriter console = Console.Out;
            var output = new StringWriter();
            Console.SetOut(TextWriter.Synchronized(output));
            var clock = Stopwatch.StartNew();
            _watchdog.Watch(test);
            TestResult result;
            try
            {
                LogExpectations.Begin();
                result = Result(test, RunGuarded(test));
            }
            finally
            {
                _watchdog.Relax();
                Console.Out.Flush();
                Console.SetOut(console);
            }
            result.Seconds = clock.Elapsed.TotalSeconds;
            result.Output = output.ToString();
            return result;
        }

        private static TestResult Result(TestCase test, Exception problem)
        {
            if (problem == null || problem is SuccessException)
            {
                return new TestResult(test.Name, Outcome.Passed, "");
            }
            if (problem is IgnoreException || problem is InconclusiveException)
            {
                return new TestResult(test.Name, Outcome.Skipped, problem.Message);
            }
            bool isAssertion = problem is AssertionException;
            string message = isAssertion
                ? problem.Message.TrimEnd()
                : problem.GetType().FullName + ": " + problem.Message;
            for (Exception inner = problem.InnerException; inner != null; inner = inner.InnerException)
            {
                message += "\n caused by " + inner.GetType().FullName + ": " + inner.Message;
            }
            return new TestResult(test.Name, Outcome.Failed, message + "\n" + Frames(problem));
        }

        /// <summary>The stack without NUnit's and the runner's own frames.</summary>
        private static string Frames(Exception problem)
        {
            IEnumerable<string> lines = (problem.StackTrace ?? "").Split('\n').Where(
                line => !line.Contains("NUnit.Framework.") && !line.Contains("Ros2Gateway.Runner.")
                    && !line.Contains("System.Reflection.") && !line.Contains("(wrapper managed-to-native)"));
            return string.Join("\n", lines.ToArray());
        }

        private static Exception RunGuarded(TestCase test)
        {
            List<Type> hierarchy = Hierarchy(test.Fixture.Type);
            Exception problem = Guarded(() =>
            {
                foreach (Type type in hierarchy)
                {
                    InvokeMarked(test, type, typeof(SetUpAttribute));
                    InvokeMarked(test, type, typeof(UnitySetUpAttribute));
                }
                object result = Invoke(test.Method, test.Fixture.Instance, test.Arguments);
                if (test.ExpectsResult)
                {
                    Assert.AreEqual(test.ExpectedResult, result);
                }
            });
            for (int i = hierarchy.Count - 1; i >= 0; i--)
            {
                Type type = hierarchy[i];
                Exception later = Guarded(() => InvokeMarked(test, type, typeof(UnityTearDownAttribute)));
                Exception last = Guarded(() => InvokeMarked(test, type, typeof(TearDownAttribute)));
                problem = problem ?? later ?? last;
            }
            return problem ?? Guarded(LogExpectations.End);
        }

        private static Exception Guarded(Action action)
        {
            try
            {
                action();
                return null;
            }
            catch (TargetInvocationException exception)
            {
                return exception.InnerException;
            }
            catch (Exception exception)
            {
                return exception;
            }
        }

        private static void InvokeMarked(TestCase test, Type type, Type attribute)
        {
            foreach (MethodInfo method in type.GetMethods(Members | BindingFlags.DeclaredOnly))
            {
                if (method.IsDefined(attribute, false))
                {
                    Invoke(method, test.Fixture.Instance, null);
                }
            }
        }

        private static object Invoke(MethodInfo method, object instance, object[] arguments)
        {
            object result = method.Invoke(method.IsStatic ? null : instance, arguments);
            var frames = result as IEnumerator;
            if (frames != null && method.ReturnType == typeof(IEnumerator))
            {
                PlayerLoop.Run(frames);
                return null;
            }
            return result;
        }

        private static List<Type> Hierarchy(Type type)
        {
            var types = new List<Type>();
            for (; type != null && type != typeof(object); type = type.BaseType)
            {
                types.Insert(0, type);
            }
            return types;
        }
    }
}

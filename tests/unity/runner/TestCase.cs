// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Reflection;

namespace Ros2Gateway.Runner
{
    /// <summary>A class with tests. One instance serves all of them, as in NUnit.</summary>
    public sealed class Fixture
    {
        private readonly object[] _arguments;
        private object _instance;

        public Fixture(Type type, object[] arguments)
        {
            Type = type;
            _arguments = arguments;
        }

        public Type Type { get; private set; }

        public object Instance
        {
            get { return _instance ?? (_instance = Activator.CreateInstance(Type, _arguments)); }
        }
    }

    /// <summary>One run of one method with its arguments.</summary>
    public sealed class TestCase
    {
        public string Name;
        public Fixture Fixture;
        public MethodInfo Method;
        public object[] Arguments;
        public bool ExpectsResult;
        public object ExpectedResult;
        public string SkipReason;
        public int? TimeoutMs;
        public readonly SortedSet<string> Categories = new SortedSet<string>();
    }

    public enum Outcome
    {
        Passed,
        Failed,
        Skipped,
    }

    public sealed class TestResult
    {
        public TestResult(string name, Outcome outcome, string message)
        {
            Name = name;
            Outcome = outcome;
            Message = message;
        }

        public string Name { get; private set; }

        public Outcome Outcome { get; private set; }

        public string Message { get; private set; }

        /// <summary>The output and the log of the test.</summary>
        public string Output { get; set; }

        public double Seconds { get; set; }

        /// <summary>Whether the process ends after it.</summary>
        public bool IsLast { get; set; }
    }
}

// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using System.Text.RegularExpressions;

namespace UnityEngine.Stage
{
    /// <summary>The log that a test may write: as in Unity's Test Framework an error that was not expected fails
    /// it.</summary>
    public static class LogExpectations
    {
        private sealed class Expectation
        {
            public LogType Type;
            public Predicate<string> Matches;
            public string Words;
        }

        /// <summary>The true messages of a busy machine that holds up a command or an answer.</summary>
        private static readonly Regex OfABusyMachine = new Regex(
            "over 250 ms|many commands arrived together|commands stopped arriving|the gateway hung while"
            + "|guard process ended or hung|the stop overtook it|no answer from the gateway for");

        private static readonly object Lock = new object();
        private static readonly List<Expectation> Expected = new List<Expectation>();
        private static readonly List<string> Unexpected = new List<string>();

        /// <summary>LogAssert.ignoreFailingMessages.</summary>
        public static bool Lenient { get; set; }

        /// <summary>Forgets what earlier tests logged and expected.</summary>
        public static void Begin()
        {
            lock (Lock)
            {
                Expected.Clear();
                Unexpected.Clear();
                Lenient = false;
            }
        }

        /// <summary>Throws unless what was expected has come and nothing else.</summary>
        public static void End()
        {
            NoUnexpected();
            lock (Lock)
            {
                if (Expected.Count > 0)
                {
                    throw new InvalidOperationException(
                        "expected log did not appear: [" + Expected[0].Type + "] " + Expected[0].Words);
                }
            }
        }

        /// <summary>Throws if an error, assertion or exception was logged that was not expected. A busy machine fails
        /// no test: one that drives goes on.</summary>
        public static void NoUnexpected()
        {
            lock (Lock)
            {
                string first = Unexpected.Find(text => !OfABusyMachine.IsMatch(text));
                if (first != null)
                {
                    throw new InvalidOperationException("unhandled log message: " + first);
                }
            }
        }

        public static void Expect(LogType type, string message)
        {
            Add(new Expectation { Type = type, Matches = text => text == message, Words = message });
        }

        public static void Expect(LogType type, Regex message)
        {
            Add(new Expectation { Type = type, Matches = message.IsMatch, Words = message.ToString() });
        }

        internal static void Take(LogType type, string text)
        {
            lock (Lock)
            {
                int index = Expected.FindIndex(e => e.Type == type && e.Matches(text));
                if (index >= 0)
                {
                    Expected.RemoveAt(index);
                }
                else if (!Lenient && type != LogType.Log && type != LogType.Warning)
                {
                    Unexpected.Add("[" + type + "] " + text);
                }
            }
        }

        private static void Add(Expectation expectation)
        {
            lock (Lock)
            {
                // earlier lines also count
                string earlier = Unexpected.Find(
                    entry => entry.StartsWith("[" + expectation.Type + "] ", StringComparison.Ordinal)
                        && expectation.Matches(entry.Substring(entry.IndexOf(' ') + 1)));
                if (earlier != null)
                {
                    Unexpected.Remove(earlier);
                }
                else
                {
                    Expected.Add(expectation);
                }
            }
        }
    }
}

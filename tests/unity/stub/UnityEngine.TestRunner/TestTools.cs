// SPDX-License-Identifier: Apache-2.0
using System;
using System.Text.RegularExpressions;
using UnityEngine.Stage;

namespace UnityEngine.TestTools
{
    [AttributeUsage(AttributeTargets.Method)]
    public class UnityTestAttribute : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Method)]
    public class UnitySetUpAttribute : Attribute
    {
    }

    [AttributeUsage(AttributeTargets.Method)]
    public class UnityTearDownAttribute : Attribute
    {
    }

    public static class LogAssert
    {
        public static bool ignoreFailingMessages
        {
            get { return LogExpectations.Lenient; }
            set { LogExpectations.Lenient = value; }
        }

        public static void Expect(LogType type, string message)
        {
            LogExpectations.Expect(type, message);
        }

        public static void Expect(LogType type, Regex message)
        {
            LogExpectations.Expect(type, message);
        }

        public static void NoUnexpectedReceived()
        {
            LogExpectations.NoUnexpected();
        }
    }
}

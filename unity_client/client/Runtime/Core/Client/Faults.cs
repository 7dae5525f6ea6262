// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>Takes note of an exception of a handler of the application's, and how many it has thrown by now.</summary>
    internal delegate void FaultReport(string where, Exception error, long times);

    /// <summary>How an exception of a handler of the application's is told.</summary>
    internal static class Faults
    {
        /// <summary>The event of the first, the 10th, 100th ... time. Null for all others.</summary>
        /// <param name="where">The handler, for people: "handler of /odom".</param>
        internal static GatewayEvent Event(string where, Exception error, long times)
        {
            if (!IsPowerOfTen(times))
            {
                return null;
            }
            string often = times == 1 ? "" : ", " + times + " times by now";
            string text = where + " threw " + error.GetType().Name + often + ": " + error.Message;
            return new GatewayEvent(EventLevel.Error, text, "client", "", error);
        }

        private static bool IsPowerOfTen(long number)
        {
            while (number >= 10 && number % 10 == 0)
            {
                number /= 10;
            }
            return number == 1;
        }
    }
}

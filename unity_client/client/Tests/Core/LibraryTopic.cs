// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.Threading;
using NUnit.Framework;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Messages.StdMsgs;
using static Ros2Gateway.Thesis.Ros2Library;

namespace Ros2Gateway.Tests
{
    /// <summary>A topic that the library of 2021 publishes and polls itself.</summary>
    internal static class LibraryTopic
    {
        private const string Last = "the last before the test";
        private const int TimeoutMilliseconds = 120000; // a machine may be busy with other things

        /// <summary>Adds a publisher and a subscriber, and returns when they have found each other and nothing is on its way.</summary>
        public static void Open(string topic, int type, int backlog = 10)
        {
            Assert.IsTrue(add_publisher(topic, type, 10));
            Assert.IsTrue(add_subscriber(topic, type, backlog, 10));
            Settle(topic, Messages.MessageCatalogue.Create(type.ToString()));
        }

        /// <summary>Sends until one has come. Then a message that is known again, and takes all up to that.</summary>
        public static void Settle(string topic, IMessage message)
        {
            IMessage found = null;
            Until(() => poll(topic, out found), "for the first on " + topic, () => send(topic, message));
            IMessage last = Marked(message.RosType);
            Until(() => send(topic, last), "to send the last on " + topic);
            Until(() => poll(topic, out found) && IsMarked(found), "for the last on " + topic);
        }

        /// <summary>Takes the oldest text.</summary>
        public static bool PollText(string topic, out string text)
        {
            bool isThere = poll(topic, out StringMsg message);
            text = message?.data ?? "";
            return isThere;
        }

        public static void Until(Func<bool> holds, string what, Action again = null)
        {
            Stopwatch watch = Stopwatch.StartNew();
            while (!holds())
            {
                if (again != null)
                {
                    again();
                }
                if (watch.ElapsedMilliseconds > TimeoutMilliseconds)
                {
                    string debug;
                    string heard = "";
                    while (poll_debug_message(out debug))
                    {
                        heard += debug + " | ";
                    }
                    Assert.Fail("waited in vain " + what + "; heard: " + heard);
                }
                Thread.Sleep(2);
            }
        }

        private static IMessage Marked(string type)
        {
            IMessage message = Messages.MessageCatalogue.Create(type);
            StringMsg text = message as StringMsg;
            TwistMsg twist = message as TwistMsg;
            if (text != null)
            {
                text.data = Last;
            }
            else if (twist != null)
            {
                twist.linear.z = Last.Length;
            }
            else
            {
                HeaderOf(message).frame_id = Last;
            }
            return message;
        }

        private static bool IsMarked(IMessage message)
        {
            StringMsg text = message as StringMsg;
            TwistMsg twist = message as TwistMsg;
            return text != null ? text.data == Last
                : twist != null ? twist.linear.z == Last.Length
                : HeaderOf(message).frame_id == Last;
        }

        private static HeaderMsg HeaderOf(IMessage message)
        {
            HeaderMsg header = message as HeaderMsg;
            return header
                ?? (message as PoseStampedMsg)?.header
                ?? (message as PoseWithCovarianceStampedMsg)?.header
                ?? (message as BatteryStateMsg)?.header
                ?? ((LaserScanMsg)message).header;
        }
    }
}

// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.IO;
using System.Text;

namespace Ros2Gateway.Unity
{
    /// <summary>
    /// Stands in for the declarations of the .jslib's functions: passes each call on to a page under Node, whose
    /// command line the environment gives.
    /// </summary>
    internal static class WebGlSocket
    {
        internal const int Open = 1;
        internal const int Closed = 3;

        private static readonly Process Page = Start();

        internal static int Connect(byte[] url, int urlBytes, int maxMessageBytes, int maxInboxBytes)
        {
            return Call(null, "Open", In(url, urlBytes), urlBytes, maxMessageBytes, maxInboxBytes);
        }

        internal static int State(int handle)
        {
            return Call(null, "State", handle);
        }

        internal static int FrameBytes(int handle)
        {
            return Call(null, "FrameBytes", handle);
        }

        internal static int Receive(int handle, byte[] buffer, int capacity)
        {
            return Call(buffer, "Receive", handle, "o:" + capacity, capacity);
        }

        internal static int Send(int handle, byte[] buffer, int bytes)
        {
            return Call(null, "Send", handle, In(buffer, bytes), bytes);
        }

        internal static int BufferedBytes(int handle)
        {
            return Call(null, "BufferedBytes", handle);
        }

        internal static void Close(int handle, int code, byte[] reason, int reasonBytes)
        {
            Call(null, "Close", handle, code, In(reason, reasonBytes), reasonBytes);
        }

        internal static int CloseCode(int handle)
        {
            return Call(null, "CloseCode", handle);
        }

        internal static int CloseReason(int handle, byte[] buffer, int capacity)
        {
            return Call(buffer, "CloseReason", handle, "o:" + capacity, capacity);
        }

        internal static void Free(int handle)
        {
            Call(null, "Free", handle);
        }

        private static string In(byte[] bytes, int count)
        {
            return "b:" + Convert.ToBase64String(bytes, 0, count);
        }

        private static int Call(byte[] output, string name, params object[] arguments)
        {
            Page.StandardInput.WriteLine(name + " " + string.Join(" ", arguments));
            Page.StandardInput.Flush();
            string[] words = Page.StandardOutput.ReadLine().Split(' ');
            if (output != null)
            {
                byte[] bytes = Convert.FromBase64String(words[1]);
                Array.Copy(bytes, output, bytes.Length);
            }
            return int.Parse(words[0]);
        }

        private static Process Start()
        {
            var start = new ProcessStartInfo("node", Environment.GetEnvironmentVariable("WEBGL_PAGE_ARGUMENTS"))
            {
                UseShellExecute = false,
                RedirectStandardInput = true,
                RedirectStandardOutput = true,
            };
            return Process.Start(start);
        }
    }
}

// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.IO;
using System.Threading;
using Ros2Gateway;
using Ros2Gateway.Json;
using Ros2Gateway.Messages;

namespace Ros2Gateway.Benchmarks
{
    /// <summary>
    /// <c>read TYPE FILE</c> times reading a message from JSON; <c>receive TYPE URL SECONDS</c> subscribes
    /// as a scene does, pumped 60 times a second, and tells what came and what it took. Both print JSON.
    /// </summary>
    internal static class Program
    {
        private const int FrameMilliseconds = 16;
        private const double BatchSeconds = 0.2; // long against the clock, short against the machine's moods

        private static int Main(string[] arguments)
        {
            switch (arguments[0])
            {
                case "read":
                    Read(arguments[1], File.ReadAllBytes(arguments[2]));
                    return 0;
                case "receive":
                    Receive(arguments[1], arguments[2], double.Parse(arguments[3]));
                    return 0;
                default:
                    return 2;
            }
        }

        private static void Read(string type, byte[] json)
        {
            JsonReader reader = new JsonReader();
            double best = double.MaxValue;
            for (int batch = 0; batch < 10; batch++)
            {
                Stopwatch watch = Stopwatch.StartNew();
                int count = 0;
                for (; watch.Elapsed.TotalSeconds < BatchSeconds; count++)
                {
                    reader.Reset(json, 0, json.Length);
                    MessageCatalogue.Create(type).Read(reader);
                }
                best = Math.Min(best, watch.Elapsed.TotalMilliseconds * 1000 / count);
            }
            Print(JsonValue.Object().With("us", best).With("bytes", json.Length));
        }

        private static void Receive(string type, string address, double seconds)
        {
            GatewayClient client = new GatewayClient(new GatewayOptions { Address = address });
            long handled = 0;
            Subscription<IMessage> subscription = client.Subscribe<IMessage>(
                "/benchmark", type, () => MessageCatalogue.Create(type), message => handled++);
            client.Connect();
            while (subscription.Received == 0)
            {
                Frame(client);
            }
            Process process = Process.GetCurrentProcess();
            for (int i = 0; i < 100; i++)
            {
                Frame(client); // code is compiled at its first use
            }
            process.Refresh();
            TimeSpan cpuBefore = process.TotalProcessorTime;
            long before = subscription.Received;
            long collections = GC.CollectionCount(0);
            double inPump = 0;
            long frames = 0;
            Stopwatch watch = Stopwatch.StartNew();
            while (watch.Elapsed.TotalSeconds < seconds)
            {
                inPump += Frame(client);
                frames++;
            }
            double elapsed = watch.Elapsed.TotalSeconds;
            process.Refresh();
            Print(JsonValue.Object()
                .With("received_per_s", (subscription.Received - before) / elapsed)
                .With("cpu_percent", (process.TotalProcessorTime - cpuBefore).TotalSeconds / elapsed * 100)
                .With("main_thread_us_per_frame", inPump * 1000 / frames)
                .With("collections_per_s", (GC.CollectionCount(0) - collections) / elapsed));
            client.Dispose();
        }

        // One frame of a scene; returns how long it was in the pump, in ms.
        private static double Frame(GatewayClient client)
        {
            Stopwatch watch = Stopwatch.StartNew();
            client.Pump();
            double inPump = watch.Elapsed.TotalMilliseconds;
            Thread.Sleep(Math.Max(0, FrameMilliseconds - (int)watch.ElapsedMilliseconds));
            return inPump;
        }

        private static void Print(JsonValue result)
        {
            Console.WriteLine(result.ToString());
        }
    }
}

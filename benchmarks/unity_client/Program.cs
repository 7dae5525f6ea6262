// SPDX-License-Identifier: Apache-2.0
using System;
using System.Diagnostics;
using System.IO;
using System.Threading;
using Ros2Gateway;
using Ros2Gateway.Json;
using Ros2Gateway.Messages;
using Ros2Gateway.Messages.GeometryMsgs;
using Ros2Gateway.Messages.NavMsgs;
using Ros2Gateway.Messages.SensorMsgs;
using Ros2Gateway.Pictures;

namespace Ros2Gateway.Benchmarks
{
    /// <summary>
    /// <c>read TYPE FILE json|cbor</c> times reading a message, in new objects and in one that is filled again.
    ///
    /// <c>receive TYPE URL SECONDS new|reuse NURSERY</c> subscribes as a scene does, pumped 60 times a second.
    /// It decodes images, and reports messages, time, and allocations. <c>decode FILE</c> times the decoder
    /// of JPEG. All print JSON.
    /// </summary>
    internal static class Program
    {
        private const int FrameMilliseconds = 16;
        private const double BatchSeconds = 0.1; // of CPU: ten ticks of the clock that counts it
        private const int Batches = 5;

        private static int Main(string[] arguments)
        {
            MessageCatalogue.Register<PoseStampedMsg>();
            MessageCatalogue.Register<OdometryMsg>();
            MessageCatalogue.Register<LaserScanMsg>();
            MessageCatalogue.Register<PointCloud2Msg>();
            MessageCatalogue.Register<CompressedImageMsg>();
            switch (arguments[0])
            {
                case "read":
                    Read(arguments[1], File.ReadAllBytes(arguments[2]), arguments[3] == "cbor");
                    return 0;
                case "receive":
                    Receive(arguments[1], arguments[2], double.Parse(arguments[3]), arguments[4] == "reuse",
                        int.Parse(arguments[5]));
                    return 0;
                case "decode":
                    Decode(File.ReadAllBytes(arguments[1]));
                    return 0;
                default:
                    return 2;
            }
        }

        private static void Read(string type, byte[] text, bool isCbor)
        {
            JsonReader reader = isCbor ? new CborReader() : new JsonReader();
            IMessage message = MessageCatalogue.Create(type);
            double anew = BestMicroseconds(() =>
            {
                reader.Reset(text, 0, text.Length);
                message.Read(reader);
            });
            double best = BestMicroseconds(() =>
            {
                reader.Reset(text, 0, text.Length);
                MessageCatalogue.Create(type).Read(reader);
            });
            Print(JsonValue.Object().With("us", best).With("us_filled_anew", anew).With("bytes", text.Length));
        }

        private static void Decode(byte[] jpeg)
        {
            JpegDecoder decoder = new JpegDecoder();
            byte[] pixels = null;
            double best = BestMicroseconds(() => decoder.Decode(jpeg, jpeg.Length, ref pixels));
            Print(JsonValue.Object().With("us", best));
        }

        private static void Receive(string type, string address, double seconds, bool reuse, int nurseryBytes)
        {
            GatewayClient client = new GatewayClient(new GatewayOptions { Address = address });
            BackgroundDecoder decoder = new BackgroundDecoder();
            long handled = 0;
            Subscription<IMessage> subscription = client.Subscribe<IMessage>(
                "/benchmark", type, Creator(type, reuse), message => handled++, null,
                message => Offer(decoder, message), reuse);
            client.Connect();
            while (subscription.Received == 0)
            {
                Frame(client, decoder);
            }
            Process process = Process.GetCurrentProcess();
            for (int i = 0; i < 100; i++)
            {
                Frame(client, decoder); // code is compiled at its first use
            }
            process.Refresh();
            TimeSpan cpuBefore = process.TotalProcessorTime;
            long before = subscription.Received;
            int minor = GC.CollectionCount(0);
            int major = GC.CollectionCount(1);
            long large = GC.GetTotalMemory(false);
            double inFrames = 0;
            long frames = 0;
            Stopwatch watch = Stopwatch.StartNew();
            while (watch.Elapsed.TotalSeconds < seconds)
            {
                inFrames += Frame(client, decoder);
                frames++;
            }
            double elapsed = watch.Elapsed.TotalSeconds;
            process.Refresh();
            long received = subscription.Received - before;
            // Of all threads: what is collected when the nursery is full, and large objects, which go past it and
            // stay until the first major collection.
            large = GC.GetTotalMemory(false) - large;
            double small = (double)(GC.CollectionCount(0) - minor) * nurseryBytes;
            bool isKnown = GC.CollectionCount(1) == major;
            Print(JsonValue.Object()
                .With("received_per_s", received / elapsed)
                .With("cpu_percent", (process.TotalProcessorTime - cpuBefore).TotalSeconds / elapsed * 100)
                .With("main_thread_us_per_frame", inFrames * 1000 / frames)
                .With("allocated_per_message", isKnown ? (large + small) / received : double.NaN));
            client.Dispose();
        }

        private static Func<IMessage> Creator(string type, bool reuse)
        {
            if (reuse && type == CompressedImageMsg.Type)
            {
                return () => new PictureMsg();
            }
            return () => MessageCatalogue.Create(type);
        }

        private static void Offer(BackgroundDecoder decoder, IMessage message)
        {
            CompressedImageMsg picture = message as CompressedImageMsg;
            PictureMsg filledAnew = message as PictureMsg;
            if (filledAnew != null)
            {
                decoder.Offer(filledAnew.buffer, filledAnew.count, filledAnew.format);
            }
            else if (picture != null)
            {
                decoder.Offer(picture.data, picture.format);
            }
        }

        // One frame of a scene, without what Unity does itself. Returns how long it was busy, in ms.
        private static double Frame(GatewayClient client, BackgroundDecoder decoder)
        {
            Stopwatch watch = Stopwatch.StartNew();
            client.Pump();
            DecodedPicture picture = decoder.Take();
            if (picture != null)
            {
                decoder.GiveBack(picture);
            }
            double busy = watch.Elapsed.TotalMilliseconds;
            Thread.Sleep(Math.Max(0, FrameMilliseconds - (int)watch.ElapsedMilliseconds));
            return busy;
        }

        private static double BestMicroseconds(Action act)
        {
            double best = double.MaxValue;
            for (int batch = 0; batch < Batches; batch++)
            {
                double began = CpuSeconds();
                double seconds = 0;
                int count = 0;
                for (int some = 1; seconds < BatchSeconds; some *= 2)
                {
                    for (int i = 0; i < some; i++, count++)
                    {
                        act();
                    }
                    seconds = CpuSeconds() - began;
                }
                best = Math.Min(best, seconds * 1000000 / count);
            }
            return best;
        }

        // Other programs on the machine affect it little.
        private static double CpuSeconds()
        {
            return Process.GetCurrentProcess().TotalProcessorTime.TotalSeconds;
        }

        private static void Print(JsonValue result)
        {
            Console.WriteLine(result.ToString());
        }
    }
}

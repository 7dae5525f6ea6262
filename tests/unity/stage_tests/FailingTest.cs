// SPDX-License-Identifier: Apache-2.0
using System;
using System.Threading;
using System.Threading.Tasks;
using NUnit.Framework;
using UnityEngine;

namespace Ros2Gateway.Stage.Tests
{
    /// <summary>A test that has to fail.</summary>
    [TestFixture]
    [Category("Failing")]
    public class FailingTest
    {
        [Test]
        public void Comparison()
        {
            Console.WriteLine("before it");
            Assert.AreEqual(1, 2, "one is not two");
        }

        [Test]
        public void Exception()
        {
            throw new InvalidOperationException("outer", new FormatException("inner"));
        }

        [Test]
        public void Logged_error()
        {
            Debug.LogError("nobody expected this");
        }

        [Test]
        [Timeout(300)]
        public void Deadlock()
        {
            // the continuation waits for a frame, the frame for the continuation
            Forever().Wait();
        }

        [Test]
        public void Death()
        {
            var thread = new Thread(() => { throw new InvalidOperationException("in a thread"); });
            thread.Start();
            thread.Join();
            Thread.Sleep(Timeout.Infinite);
        }

        private static async Task Forever()
        {
            await Task.Yield();
        }
    }
}

// SPDX-License-Identifier: Apache-2.0
using System;
using System.IO;
using System.Threading;

namespace Ros2Gateway.Runner
{
    /// <summary>Ends the process when a test runs too long: a blocked thread cannot be freed.</summary>
    public sealed class Watchdog : IDisposable
    {
        private readonly double _defaultTimeoutS;
        private readonly TextWriter _output;
        private readonly Timer _timer;
        private string _test;
        private double _timeoutS;

        public Watchdog(double timeoutS, TextWriter output)
        {
            _defaultTimeoutS = timeoutS;
            _output = output;
            _timer = new Timer(GiveUp, null, Timeout.Infinite, Timeout.Infinite);
        }

        public void Watch(TestCase test)
        {
            _test = test.Name;
            _timeoutS = test.TimeoutMs.HasValue ? test.TimeoutMs.Value / 1000.0 : _defaultTimeoutS;
            _timer.Change(TimeSpan.FromSeconds(_timeoutS), Timeout.InfiniteTimeSpan);
        }

        public void Relax()
        {
            _timer.Change(Timeout.Infinite, Timeout.Infinite);
        }

        public void Dispose()
        {
            _timer.Dispose();
        }

        private void GiveUp(object state)
        {
            string message = "still running after " + _timeoutS + " s";
            var result = new TestResult(_test, Outcome.Failed, message) { IsLast = true };
            _output.WriteLine(Report.Line(result));
            _output.Flush();
            Environment.Exit(3);
        }
    }
}

// SPDX-License-Identifier: Apache-2.0
using System.Diagnostics;

namespace Ros2Gateway
{
    /// <summary>A clock that never goes back.</summary>
    internal sealed class Clock
    {
        private readonly Stopwatch _watch = Stopwatch.StartNew();

        /// <summary>Milliseconds since the client was made.</summary>
        internal long Now => _watch.ElapsedMilliseconds;

        /// <summary>The same with fractions, for measuring.</summary>
        internal double Precise => _watch.Elapsed.TotalMilliseconds;
    }
}

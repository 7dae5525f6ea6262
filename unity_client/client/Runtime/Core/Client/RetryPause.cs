// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>
    /// When to ask again for what was refused: after a pause that doubles with each refusal. Not thread-safe.
    /// </summary>
    internal sealed class RetryPause
    {
        // A node that is asked for a type's definition answers within this. It doubles with each refusal.
        private const long FirstMilliseconds = 1000;
        private const long LongestMilliseconds = 30000; // a conflict that lasts is for people to solve

        private long _pause = FirstMilliseconds;
        private long _until;

        /// <summary>It was refused. The next pause begins.</summary>
        internal void Begin(long now)
        {
            _until = now + _pause;
            _pause = _pause < LongestMilliseconds / 2 ? 2 * _pause : LongestMilliseconds;
        }

        /// <summary>Whether the pause that was begun is over.</summary>
        internal bool IsOver(long now) => now >= _until;

        /// <summary>It was granted, or the connection is another: the next pause is short again.</summary>
        internal void Forget() => _pause = FirstMilliseconds;
    }
}

// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>
    /// How many messages may wait in a queue. A number may be left over from frame to frame. All that
    /// came within the last two frames of the application wait in addition. The depth alone would cut every burst, as the
    /// application looks once per frame. A depth of 1 is the newest alone.
    /// </summary>
    /// <remarks>A frame is one call of <see cref="Mailbox.Pump"/>. Its owner locks.</remarks>
    internal sealed class QueueBound
    {
        // Of a burst: as many as the gateway lets wait for a client.
        internal const int BurstMessages = 1024;

        // Of a burst: a thousand poses, ten pictures of 100 kB. Larger ones wait by the depth.
        internal const int BurstBytes = 1024 * 1024;

        private readonly Mailbox _mailbox;
        private readonly bool _keepsBursts;
        private int _frame;
        private int _fresh; // came in this frame
        private int _beforeThat; // and in the one before: who takes messages by itself does so after the pump
        private int _waiting;
        private long _bytes;

        /// <param name="keepsBursts">False where the depth is all, as a library of old had it.</param>
        internal QueueBound(Mailbox mailbox, int depth, bool keepsBursts)
        {
            _mailbox = mailbox;
            _keepsBursts = keepsBursts;
            Depth = depth < 1 ? 1 : depth;
        }

        /// <summary>How many may be left over from frame to frame.</summary>
        internal int Depth { get; set; }

        /// <summary>Whether the oldest has to make room.</summary>
        internal bool IsExceeded
        {
            get
            {
                bool isOfABurst = _keepsBursts && Depth > 1 && _waiting <= _fresh + _beforeThat
                    && _waiting <= BurstMessages && _bytes <= BurstBytes;
                return _waiting > Depth && !isOfABurst;
            }
        }

        internal void Add(int bytes)
        {
            int frame = _mailbox.Frame;
            if (frame != _frame)
            {
                _beforeThat = frame == _frame + 1 ? _fresh : 0;
                _fresh = 0;
                _frame = frame;
            }
            _fresh++;
            _waiting++;
            _bytes += bytes;
        }

        internal void Remove(int bytes)
        {
            _waiting--;
            _bytes -= bytes;
        }
    }
}

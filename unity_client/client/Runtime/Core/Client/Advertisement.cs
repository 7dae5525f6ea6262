// SPDX-License-Identifier: Apache-2.0
namespace Ros2Gateway
{
    /// <summary>
    /// Whether the gateway has refused to advertise, and when to ask it again: what stands in the way may be gone,
    /// such as a node with another type. It says nothing when it agrees. A pong that comes back without a refusal
    /// before it does.
    /// </summary>
    internal sealed class Advertisement
    {
        private readonly object _gate = new();
        private readonly RetryPause _pause = new();
        private volatile string _refusal;
        private double _asked = double.NaN; // when it was asked, and has not agreed yet
        private volatile bool _isAgreed;

        /// <summary>Why not, in the gateway's words, or null.</summary>
        internal string Refusal => _refusal;

        /// <summary>
        /// Whether the gateway is known to have agreed. Until then messages name their type: without an advertisement
        /// the gateway would make one for them, of the type that the topic has.
        /// </summary>
        internal bool IsAgreed => _isAgreed;

        /// <summary>It is refused. Returns whether that is news.</summary>
        internal bool Refuse(string errorText, long now)
        {
            lock (_gate)
            {
                bool isNews = _refusal != errorText;
                _refusal = errorText;
                _isAgreed = false;
                _asked = double.NaN;
                _pause.Begin(now);
                return isNews;
            }
        }

        /// <summary>Whether to ask again now.</summary>
        internal bool IsDue(long now)
        {
            lock (_gate)
            {
                return _refusal != null && double.IsNaN(_asked) && _pause.IsOver(now);
            }
        }

        /// <summary>It was just asked for.</summary>
        internal void Ask(double now)
        {
            lock (_gate)
            {
                _asked = now;
            }
        }

        /// <summary>A ping that left at that time is back.</summary>
        internal void OnPong(double sent)
        {
            lock (_gate)
            {
                if (sent >= _asked) // false while it was not asked
                {
                    Forget();
                    _isAgreed = true;
                }
            }
        }

        /// <summary>On a new connection nothing is refused yet.</summary>
        internal void Forget()
        {
            lock (_gate)
            {
                _refusal = null;
                _isAgreed = false;
                _asked = double.NaN;
                _pause.Forget();
            }
        }
    }
}

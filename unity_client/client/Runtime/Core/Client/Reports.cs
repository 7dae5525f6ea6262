// SPDX-License-Identifier: Apache-2.0
using System.Collections.Generic;

namespace Ros2Gateway
{
    /// <summary>Makes events, and keeps one that repeats itself from burying the others.</summary>
    internal sealed class Reports
    {
        // The same words at most once in this time: a handler that fails at 60 Hz is one piece of news.
        private const long RepeatMilliseconds = 5000;

        // More different words than this are forgotten together. They differ by more than their numbers then.
        private const int MaxRemembered = 256;

        private readonly Mailbox _mailbox;
        private readonly Clock _clock;
        private readonly Dictionary<string, long> _last = new();

        internal Reports(Mailbox mailbox, Clock clock) =>
            (_mailbox, _clock) = (mailbox, clock);

        internal void Error(string request, string text) => Tell(EventLevel.Error, text, "client", request);

        /// <summary>Tells why a request failed. The log has no error if the application handles it.</summary>
        internal void Failure(string request, string text, bool isHandled) =>
            Tell(isHandled ? EventLevel.Info : EventLevel.Error, text, "client", request);

        internal void Tell(EventLevel level, string text, string code, string request)
        {
            long now = _clock.Now;
            string key = request + "\n" + text;
            lock (_last)
            {
                if (_last.TryGetValue(key, out long last) && now - last < RepeatMilliseconds)
                {
                    return;
                }
                if (_last.Count >= MaxRemembered)
                {
                    _last.Clear();
                }
                _last[key] = now;
            }
            _mailbox.Report(new GatewayEvent(level, text, code, request));
        }
    }
}

// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>How severe an event is. The numbers rise with it.</summary>
    public enum EventLevel
    {
        /// <summary>Something was done.</summary>
        Info,

        /// <summary>Something may not be as it was meant.</summary>
        Warning,

        /// <summary>Something failed.</summary>
        Error,
    }

    /// <summary>Something that people should know: words of the gateway, or of this client.</summary>
    public sealed class GatewayEvent
    {
        /// <summary>How severe it is.</summary>
        public readonly EventLevel Level;

        /// <summary>The event in words: what happened, where, and what to do.</summary>
        public readonly string Text;

        /// <summary>For programs: the gateway's code (not_found, bad_type ...), or "client" for the client's own.</summary>
        public readonly string Code;

        /// <summary>The operation that this is about, or an empty string.</summary>
        public readonly string Request;

        /// <summary>When it happened, by this machine's clock.</summary>
        public readonly DateTime Time;

        /// <summary>The exception behind it, if the cause was a handler of the application's. Else null.</summary>
        public readonly Exception Exception;

        internal GatewayEvent(EventLevel level, string text, string code, string request, Exception exception = null)
        {
            Level = level;
            Text = text;
            Code = code;
            Request = request;
            Time = DateTime.UtcNow;
            Exception = exception;
        }

        /// <summary>One line for a log.</summary>
        public override string ToString()
        {
            string level = Level.ToString().ToLowerInvariant();
            return Request.Length == 0 ? level + ": " + Text : level + ": " + Request + ": " + Text;
        }
    }
}

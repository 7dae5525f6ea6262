// SPDX-License-Identifier: Apache-2.0
using System;

namespace Ros2Gateway
{
    /// <summary>The answer to a request: a value, or words that say why it is missing.</summary>
    public struct Reply<T>
    {
        /// <summary>Whether there is a value.</summary>
        public readonly bool Ok;

        /// <summary>The value. Default without a value.</summary>
        public readonly T Value;

        /// <summary>Why there is no value. Null where there is one.</summary>
        public readonly string Error;

        private Reply(bool ok, T value, string error) =>
            (Ok, Value, Error) = (ok, value, error);

        /// <summary>An answer with a value.</summary>
        public static Reply<T> Of(T value) => new Reply<T>(true, value, null);

        /// <summary>An answer without one.</summary>
        public static Reply<T> Failed(string error) => new Reply<T>(false, default(T), error);

        /// <summary>The value.</summary>
        /// <exception cref="GatewayException">It is missing.</exception>
        public T OrThrow()
        {
            if (!Ok)
            {
                throw new GatewayException(Error);
            }
            return Value;
        }
    }

    /// <summary>A request failed. The text is the gateway's, or the client's own.</summary>
    public sealed class GatewayException : Exception
    {
        /// <param name="errorText">The error in words: what happened, where, and what to do.</param>
        public GatewayException(string errorText)
            : base(errorText)
        {
        }
    }
}

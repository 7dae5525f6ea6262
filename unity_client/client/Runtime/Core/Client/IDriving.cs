// SPDX-License-Identifier: Apache-2.0
using Ros2Gateway.Json;

namespace Ros2Gateway
{
    /// <summary>The drivers of robots, as the package <c>displays</c> knows them. Any thread.</summary>
    internal interface IDriving
    {
        /// <summary>Why a topic takes no command to move, in words. Null if it does, or if nobody watches it.</summary>
        string RefusalOf(string topic);

        /// <summary>Whether a message says to stand, so that it goes in spite of that.</summary>
        bool TakesAnyway(string topic, IMessage message);

        /// <summary>The gateway has refused a message. Returns whether that refuses those after it.</summary>
        bool OnRefused(string topic, string code, string reason);

        /// <summary>The gateway tells the state of a topic, asked or not.</summary>
        void OnFrame(string op, JsonReader frame);

        /// <summary>The gateway refuses to tell a state. False if that answers no question of this part.</summary>
        bool OnUnknown(string id, string errorText);

        /// <summary>On a new connection.</summary>
        void Restore();

        /// <summary>The connection is gone.</summary>
        void OnDown();
    }
}

// SPDX-License-Identifier: Apache-2.0
using System;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>How sure delivery should be.</summary>
    public enum Reliability
    {
        /// <summary>The offer of the publishers. For a publisher, reliable.</summary>
        Automatic,

        /// <summary>Sent again until it has arrived.</summary>
        Reliable,

        /// <summary>Sent once: what is lost is lost, and nothing waits for it.</summary>
        BestEffort,
    }

    /// <summary>The messages that late subscribers get.</summary>
    public enum Durability
    {
        /// <summary>The offer of the publishers. For a publisher, volatile.</summary>
        Automatic,

        /// <summary>Nothing of what was said before.</summary>
        Volatile,

        /// <summary>The newest messages that were said before.</summary>
        TransientLocal,
    }

    /// <summary>Quality of service in the Inspector. The defaults are nearly always right.</summary>
    [Serializable]
    public sealed class QosSettings
    {
        /// <summary>How sure delivery should be.</summary>
        [Tooltip("Automatic takes what the publishers offer")]
        public Reliability Reliability;

        /// <summary>The messages that late subscribers get.</summary>
        [Tooltip("Automatic takes what the publishers offer")]
        public Durability Durability;

        /// <summary>How many messages DDS keeps. 0 for the gateway's default.</summary>
        [Tooltip("How many messages DDS keeps. 0 for the gateway's default")]
        [Range(0, 1024)]
        public int Depth;

        internal QosOptions Options()
        {
            if (Reliability == Reliability.Automatic && Durability == Durability.Automatic && Depth == 0)
            {
                return null;
            }
            return new QosOptions
            {
                Reliability = Reliability == Reliability.Automatic ? null
                    : Reliability == Reliability.Reliable ? "reliable" : "best_effort",
                Durability = Durability == Durability.Automatic ? null
                    : Durability == Durability.Volatile ? "volatile" : "transient_local",
                Depth = Depth,
            };
        }
    }
}

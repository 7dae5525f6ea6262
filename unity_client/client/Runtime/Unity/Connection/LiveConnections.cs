// SPDX-License-Identifier: Apache-2.0
using System;
using System.Collections.Generic;
using UnityEngine;

namespace Ros2Gateway.Unity
{
    /// <summary>The connections that live, over all scenes, and the listeners for their coming and going.</summary>
    /// <remarks>
    /// This is static, because a component that is enabled before any connection knows nobody who could tell it
    /// of one. Unity's own search finds only present objects, so a component that waits would search all scenes in
    /// every frame. It makes no connection, and holds none that is destroyed. The editor may keep static state from
    /// one Play to the next, so each begins without any.
    /// </remarks>
    internal static class LiveConnections
    {
        private static readonly List<GatewayConnection> Connections = new();
        private static readonly List<ConnectedBehaviour> Users = new();

        /// <summary>
        /// The connection that a component uses: its own choice. Else one that is enabled, of its scene rather than
        /// of another. Else one that is disabled. Null without one.
        /// </summary>
        /// <param name="present">The one that it uses now. It stays with that as long as nothing is better.</param>
        /// <param name="gateway">The only address that will do without a choice. Null for any.</param>
        internal static GatewayConnection Best(
            Component user, GatewayConnection chosen, GatewayConnection present, string gateway = null)
        {
            if (chosen != null && !chosen.IsOver)
            {
                return chosen;
            }
            string only = Only(chosen, present, gateway);
            GatewayConnection best = null;
            int bestRank = 0;
            foreach (GatewayConnection one in Connections)
            {
                if (only != null && one.Gateway != only)
                {
                    continue;
                }
                int rank = 1 + (one.gameObject.scene == user.gameObject.scene ? 1 : 0)
                    + (one == present ? 2 : 0) + (one.isActiveAndEnabled ? 4 : 0);
                if (rank > bestRank)
                {
                    best = one;
                    bestRank = rank;
                }
            }
            return best;
        }

        /// <summary>
        /// The address of what is to take the place of a choice that is gone, or of a connection that lives but may be
        /// disabled: another address may be another robot. Else what is given.
        /// </summary>
        internal static string Only(GatewayConnection chosen, GatewayConnection present, string gateway)
        {
            // A destroyed object equals null, and yet has a reference.
            return !ReferenceEquals(chosen, null) && chosen.IsOver ? chosen.Gateway
                : Connections.Contains(present) ? present.Gateway : gateway;
        }

        /// <summary>Another that outlives its scene, and leads to the same gateway. Null without one.</summary>
        internal static GatewayConnection Lasting(GatewayConnection other) =>
            Connections.Find(one => one != other && one.OutlivesScenes && one.Address == other.Address);

        internal static void Add(GatewayConnection connection)
        {
            if (!Connections.Contains(connection))
            {
                Connections.Add(connection);
            }
        }

        internal static void Remove(GatewayConnection connection)
        {
            Connections.Remove(connection);
            Tell();
        }

        internal static void Enter(ConnectedBehaviour user) => Users.Add(user);

        internal static void Leave(ConnectedBehaviour user) => Users.Remove(user);

        /// <summary>A connection was enabled, disabled or destroyed: everyone looks again.</summary>
        internal static void Tell()
        {
            foreach (ConnectedBehaviour user in Users.ToArray()) // listeners may come and go
            {
                try
                {
                    user.Choose();
                }
                catch (Exception error)
                {
                    Debug.LogException(error, user); // a fault of one component must not keep the others waiting
                }
            }
        }

        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        private static void Forget()
        {
            Connections.Clear();
            Users.Clear();
        }
    }
}

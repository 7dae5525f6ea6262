// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine.Stage
{
    /// <summary>When in a frame a coroutine goes on.</summary>
    internal enum Phase
    {
        FixedUpdate,
        Update,
        EndOfFrame,
    }
}

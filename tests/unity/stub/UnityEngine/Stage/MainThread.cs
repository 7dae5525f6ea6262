// SPDX-License-Identifier: Apache-2.0
using System.Threading;

namespace UnityEngine.Stage
{
    /// <summary>Refuses calls off the main thread in Unity's words.</summary>
    public static class MainThread
    {
        private static Thread _thread;

        internal static bool IsCurrent
        {
            get { return _thread == null || Thread.CurrentThread == _thread; }
        }

        internal static void Adopt()
        {
            _thread = Thread.CurrentThread;
        }

        /// <summary>To be called by every member that Unity binds to its engine.</summary>
        public static void Check(string member)
        {
            if (!IsCurrent)
            {
                throw new UnityException(member + " can only be called from the main thread.");
            }
        }
    }
}

// SPDX-License-Identifier: Apache-2.0
using UnityEngine.Stage;

namespace UnityEngine
{
    public sealed class SystemInfo
    {
        public static bool supportsAsyncGPUReadback
        {
            get { return Gpu.ReadsBack; }
        }
    }
}

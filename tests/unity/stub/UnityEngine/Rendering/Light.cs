// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine
{
    public sealed class Light : Behaviour
    {
        public LightType type { get; set; }

        public float intensity { get; set; }
    }

    public enum LightType
    {
        Spot = 0,
        Directional = 1,
        Point = 2,
    }
}

// SPDX-License-Identifier: Apache-2.0
using UnityEngine;

namespace Ros2Gateway.Unity.Tests
{
    /// <summary>The parts of a scene that displays need.</summary>
    public static class DisplayParts
    {
        /// <summary>The origin of a frame, for what is put below it. Needs a connection.</summary>
        public static FixedFrame Fixed(this DisplayScene scene, string frame)
        {
            GameObject holder = scene.Inactive("fixed");
            FixedFrame made = holder.AddComponent<FixedFrame>();
            made.Frame = frame;
            holder.SetActive(true);
            return made;
        }

        /// <summary>Gives an image screen something to show pictures on.</summary>
        public static void OnRenderer(ImageScreen screen) => screen.gameObject.AddComponent<MeshRenderer>();
    }
}

// SPDX-License-Identifier: Apache-2.0
using System;

namespace UnityEngine
{
    [Serializable]
    public struct Pose
    {
        public Vector3 position;
        public Quaternion rotation;

        public static Pose identity
        {
            get { return new Pose(Vector3.zero, Quaternion.identity); }
        }

        public Pose(Vector3 position, Quaternion rotation)
        {
            this.position = position;
            this.rotation = rotation;
        }
    }
}

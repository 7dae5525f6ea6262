// SPDX-License-Identifier: Apache-2.0
using UnityEngine.Stage;

namespace UnityEngine
{
    public class Collider : Component
    {
        private bool _enabled = true;

        public bool enabled
        {
            get { return _enabled; }
            set { _enabled = value; }
        }

        public bool isTrigger { get; set; }

        /// <summary>The box that it fills, in its own frame.</summary>
        internal virtual Bounds LocalBounds
        {
            get { return new Bounds(Vector3.zero, Vector3.one); }
        }
    }

    public class BoxCollider : Collider
    {
        private Vector3 _size = Vector3.one;

        public Vector3 center { get; set; }

        public Vector3 size
        {
            get { return _size; }
            set { _size = value; }
        }

        internal override Bounds LocalBounds
        {
            get { return new Bounds(center, size); }
        }
    }

    public class SphereCollider : Collider
    {
    }

    public class CapsuleCollider : Collider
    {
    }

    public class MeshCollider : Collider
    {
        /// <summary>Flat: as large as Unity's plane, unless it is a quad's.</summary>
        internal Vector3 Size = new Vector3(10F, 0F, 10F);

        internal override Bounds LocalBounds
        {
            get { return new Bounds(Vector3.zero, Size); }
        }
    }

    public struct RaycastHit
    {
        public Vector3 point { get; set; }

        public Vector3 normal { get; set; }

        public float distance { get; set; }

        public Collider collider
        {
            get { return Collider; }
        }

        public Transform transform
        {
            get { return Collider == null ? null : Collider.transform; }
        }

        internal Collider Collider { get; set; }
    }
}

namespace UnityEngine.Stage
{
    internal static class Primitives
    {
        public static System.Type ColliderOf(PrimitiveType type)
        {
            switch (type)
            {
                case PrimitiveType.Sphere:
                    return typeof(SphereCollider);
                case PrimitiveType.Cube:
                    return typeof(BoxCollider);
                case PrimitiveType.Capsule:
                case PrimitiveType.Cylinder:
                    return typeof(CapsuleCollider);
                default:
                    return typeof(MeshCollider);
            }
        }
    }
}

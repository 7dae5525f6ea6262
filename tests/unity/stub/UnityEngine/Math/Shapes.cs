// SPDX-License-Identifier: Apache-2.0
namespace UnityEngine
{
    public struct Ray
    {
        private Vector3 _direction;

        public Ray(Vector3 origin, Vector3 direction)
            : this()
        {
            this.origin = origin;
            _direction = direction.normalized;
        }

        public Vector3 origin { get; set; }

        public Vector3 direction
        {
            get { return _direction; }
            set { _direction = value.normalized; }
        }

        public Vector3 GetPoint(float distance)
        {
            return origin + direction * distance;
        }
    }

    public struct Bounds
    {
        public Bounds(Vector3 center, Vector3 size)
            : this()
        {
            this.center = center;
            this.size = size;
        }

        public Vector3 center { get; set; }

        public Vector3 size { get; set; }

        public Vector3 extents
        {
            get { return size * 0.5F; }
        }

        public Vector3 min
        {
            get { return center - extents; }
        }

        public Vector3 max
        {
            get { return center + extents; }
        }
    }

    public struct Rect
    {
        public Rect(float x, float y, float width, float height)
            : this()
        {
            this.x = x;
            this.y = y;
            this.width = width;
            this.height = height;
        }

        public float x { get; set; }

        public float y { get; set; }

        public float width { get; set; }

        public float height { get; set; }
    }

    public struct Vector4
    {
        public float x;
        public float y;
        public float z;
        public float w;

        public Vector4(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }
    }
}

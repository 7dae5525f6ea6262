// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace UnityEngine
{
    public struct Vector3 : IEquatable<Vector3>
    {
        public const float kEpsilon = 0.00001F;

        public float x;
        public float y;
        public float z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }

        public Vector3(float x, float y)
            : this(x, y, 0F)
        {
        }

        public static Vector3 zero
        {
            get { return new Vector3(0F, 0F, 0F); }
        }

        public static Vector3 one
        {
            get { return new Vector3(1F, 1F, 1F); }
        }

        public static Vector3 forward
        {
            get { return new Vector3(0F, 0F, 1F); }
        }

        public static Vector3 back
        {
            get { return new Vector3(0F, 0F, -1F); }
        }

        public static Vector3 up
        {
            get { return new Vector3(0F, 1F, 0F); }
        }

        public static Vector3 down
        {
            get { return new Vector3(0F, -1F, 0F); }
        }

        public static Vector3 right
        {
            get { return new Vector3(1F, 0F, 0F); }
        }

        public static Vector3 left
        {
            get { return new Vector3(-1F, 0F, 0F); }
        }

        public float magnitude
        {
            get { return Mathf.Sqrt(sqrMagnitude); }
        }

        public float sqrMagnitude
        {
            get { return x * x + y * y + z * z; }
        }

        public Vector3 normalized
        {
            get { return magnitude > kEpsilon ? this / magnitude : zero; }
        }

        public float this[int index]
        {
            get
            {
                switch (index)
                {
                    case 0: return x;
                    case 1: return y;
                    case 2: return z;
                    default: throw new IndexOutOfRangeException("Invalid Vector3 index!");
                }
            }

            set
            {
                switch (index)
                {
                    case 0: x = value; break;
                    case 1: y = value; break;
                    case 2: z = value; break;
                    default: throw new IndexOutOfRangeException("Invalid Vector3 index!");
                }
            }
        }

        public static float Dot(Vector3 lhs, Vector3 rhs)
        {
            return lhs.x * rhs.x + lhs.y * rhs.y + lhs.z * rhs.z;
        }

        public static Vector3 Cross(Vector3 lhs, Vector3 rhs)
        {
            return new Vector3(
                lhs.y * rhs.z - lhs.z * rhs.y, lhs.z * rhs.x - lhs.x * rhs.z, lhs.x * rhs.y - lhs.y * rhs.x);
        }

        public static float Distance(Vector3 a, Vector3 b)
        {
            return (a - b).magnitude;
        }

        public static float Angle(Vector3 from, Vector3 to)
        {
            float lengths = Mathf.Sqrt(from.sqrMagnitude * to.sqrMagnitude);
            return lengths < 1e-15F ? 0F
                : Mathf.Acos(Mathf.Clamp(Dot(from, to) / lengths, -1F, 1F)) * Mathf.Rad2Deg;
        }

        public static float SignedAngle(Vector3 from, Vector3 to, Vector3 axis)
        {
            return Angle(from, to) * Mathf.Sign(Dot(axis, Cross(from, to)));
        }

        public static Vector3 Scale(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x * b.x, a.y * b.y, a.z * b.z);
        }

        public static Vector3 Lerp(Vector3 a, Vector3 b, float t)
        {
            return a + (b - a) * Mathf.Clamp01(t);
        }

        public static Vector3 MoveTowards(Vector3 current, Vector3 target, float maxDistanceDelta)
        {
            Vector3 way = target - current;
            bool arrives = way.sqrMagnitude <= maxDistanceDelta * maxDistanceDelta;
            return arrives ? target : current + way.normalized * maxDistanceDelta;
        }

        public static Vector3 ClampMagnitude(Vector3 vector, float maxLength)
        {
            return vector.sqrMagnitude > maxLength * maxLength ? vector.normalized * maxLength : vector;
        }

        public static Vector3 ProjectOnPlane(Vector3 vector, Vector3 planeNormal)
        {
            return vector - planeNormal * (Dot(vector, planeNormal) / planeNormal.sqrMagnitude);
        }

        public static Vector3 Normalize(Vector3 value)
        {
            return value.normalized;
        }

        public void Normalize()
        {
            this = normalized;
        }

        public static Vector3 operator +(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
        }

        public static Vector3 operator -(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);
        }

        public static Vector3 operator -(Vector3 a)
        {
            return new Vector3(-a.x, -a.y, -a.z);
        }

        public static Vector3 operator *(Vector3 a, float d)
        {
            return new Vector3(a.x * d, a.y * d, a.z * d);
        }

        public static Vector3 operator *(float d, Vector3 a)
        {
            return a * d;
        }

        public static Vector3 operator /(Vector3 a, float d)
        {
            return new Vector3(a.x / d, a.y / d, a.z / d);
        }

        public static bool operator ==(Vector3 lhs, Vector3 rhs)
        {
            return (lhs - rhs).sqrMagnitude < 1E-10F;
        }

        public static bool operator !=(Vector3 lhs, Vector3 rhs)
        {
            return !(lhs == rhs);
        }

        public bool Equals(Vector3 other)
        {
            return x == other.x && y == other.y && z == other.z;
        }

        public override bool Equals(object other)
        {
            return other is Vector3 && Equals((Vector3)other);
        }

        public override int GetHashCode()
        {
            return (x.GetHashCode() * 31 + y.GetHashCode()) * 31 + z.GetHashCode();
        }

        public override string ToString()
        {
            return string.Format(CultureInfo.InvariantCulture, "({0:F2}, {1:F2}, {2:F2})", x, y, z);
        }
    }
}

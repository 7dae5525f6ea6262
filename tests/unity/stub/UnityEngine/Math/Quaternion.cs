// SPDX-License-Identifier: Apache-2.0
using System;
using System.Globalization;

namespace UnityEngine
{
    public struct Quaternion : IEquatable<Quaternion>
    {
        public float x;
        public float y;
        public float z;
        public float w;

        public Quaternion(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }

        public static Quaternion identity
        {
            get { return new Quaternion(0F, 0F, 0F, 1F); }
        }

        public Vector3 eulerAngles
        {
            get
            {
                // Unity turns about z, then x, then y: R = Ry Rx Rz
                float sinX = 2F * (w * x - y * z);
                Vector3 angles;
                if (Mathf.Abs(sinX) > 0.999999F)
                {
                    angles = new Vector3(Mathf.Sign(sinX) * Mathf.PI / 2F, 2F * Mathf.Atan2(y, w), 0F);
                }
                else
                {
                    angles = new Vector3(
                        Mathf.Asin(sinX),
                        Mathf.Atan2(2F * (w * y + x * z), 1F - 2F * (x * x + y * y)),
                        Mathf.Atan2(2F * (w * z + x * y), 1F - 2F * (x * x + z * z)));
                }
                angles *= Mathf.Rad2Deg;
                return new Vector3(Positive(angles.x), Positive(angles.y), Positive(angles.z));
            }

            set
            {
                this = Euler(value);
            }
        }

        public Quaternion normalized
        {
            get
            {
                float length = Mathf.Sqrt(Dot(this, this));
                return length < Mathf.Epsilon ? identity
                    : new Quaternion(x / length, y / length, z / length, w / length);
            }
        }

        public static Quaternion Euler(float x, float y, float z)
        {
            return AngleAxis(y, Vector3.up) * AngleAxis(x, Vector3.right) * AngleAxis(z, Vector3.forward);
        }

        public static Quaternion Euler(Vector3 euler)
        {
            return Euler(euler.x, euler.y, euler.z);
        }

        public static Quaternion AngleAxis(float angle, Vector3 axis)
        {
            if (axis.sqrMagnitude == 0F)
            {
                return identity;
            }
            float half = angle * Mathf.Deg2Rad / 2F;
            Vector3 part = axis.normalized * Mathf.Sin(half);
            return new Quaternion(part.x, part.y, part.z, Mathf.Cos(half));
        }

        public static Quaternion LookRotation(Vector3 forward)
        {
            return LookRotation(forward, Vector3.up);
        }

        public static Quaternion LookRotation(Vector3 forward, Vector3 upwards)
        {
            Vector3 z = forward.normalized;
            Vector3 x = Vector3.Cross(upwards, z).normalized;
            if (z == Vector3.zero)
            {
                return identity;
            }
            if (x == Vector3.zero)
            {
                return FromToRotation(Vector3.forward, z);
            }
            Vector3 y = Vector3.Cross(z, x);
            return FromAxes(x, y, z);
        }

        public static Quaternion FromToRotation(Vector3 fromDirection, Vector3 toDirection)
        {
            Vector3 axis = Vector3.Cross(fromDirection, toDirection);
            if (axis.sqrMagnitude < 1e-12F)
            {
                Vector3 across = Vector3.Cross(fromDirection, Vector3.up);
                bool same = Vector3.Dot(fromDirection, toDirection) >= 0F;
                return same ? identity
                    : AngleAxis(180F, across.sqrMagnitude > 1e-6F ? across : Vector3.right);
            }
            return AngleAxis(Vector3.Angle(fromDirection, toDirection), axis);
        }

        public static Quaternion Inverse(Quaternion rotation)
        {
            float square = Dot(rotation, rotation);
            return new Quaternion(
                -rotation.x / square, -rotation.y / square, -rotation.z / square, rotation.w / square);
        }

        public static float Dot(Quaternion a, Quaternion b)
        {
            return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
        }

        public static float Angle(Quaternion a, Quaternion b)
        {
            float dot = Mathf.Min(Mathf.Abs(Dot(a, b)), 1F);
            return dot > 1F - 0.000001F ? 0F : Mathf.Acos(dot) * 2F * Mathf.Rad2Deg;
        }

        public static Quaternion Slerp(Quaternion a, Quaternion b, float t)
        {
            t = Mathf.Clamp01(t);
            float cos = Dot(a, b);
            float sign = cos < 0F ? -1F : 1F;
            float angle = Mathf.Acos(Mathf.Min(Mathf.Abs(cos), 1F));
            bool close = angle < 1e-3F;
            float partA = close ? 1F - t : Mathf.Sin((1F - t) * angle) / Mathf.Sin(angle);
            float partB = sign * (close ? t : Mathf.Sin(t * angle) / Mathf.Sin(angle));
            return new Quaternion(
                partA * a.x + partB * b.x, partA * a.y + partB * b.y,
                partA * a.z + partB * b.z, partA * a.w + partB * b.w).normalized;
        }

        public static Quaternion RotateTowards(Quaternion from, Quaternion to, float maxDegreesDelta)
        {
            float angle = Angle(from, to);
            return angle == 0F ? to : Slerp(from, to, Mathf.Min(1F, maxDegreesDelta / angle));
        }

        public static Quaternion operator *(Quaternion lhs, Quaternion rhs)
        {
            return new Quaternion(
                lhs.w * rhs.x + lhs.x * rhs.w + lhs.y * rhs.z - lhs.z * rhs.y,
                lhs.w * rhs.y + lhs.y * rhs.w + lhs.z * rhs.x - lhs.x * rhs.z,
                lhs.w * rhs.z + lhs.z * rhs.w + lhs.x * rhs.y - lhs.y * rhs.x,
                lhs.w * rhs.w - lhs.x * rhs.x - lhs.y * rhs.y - lhs.z * rhs.z);
        }

        public static Vector3 operator *(Quaternion rotation, Vector3 point)
        {
            var axis = new Vector3(rotation.x, rotation.y, rotation.z);
            Vector3 twice = 2F * Vector3.Cross(axis, point);
            return point + rotation.w * twice + Vector3.Cross(axis, twice);
        }

        public static bool operator ==(Quaternion lhs, Quaternion rhs)
        {
            return Dot(lhs, rhs) > 1F - 0.000001F;
        }

        public static bool operator !=(Quaternion lhs, Quaternion rhs)
        {
            return !(lhs == rhs);
        }

        public bool Equals(Quaternion other)
        {
            return x == other.x && y == other.y && z == other.z && w == other.w;
        }

        public override bool Equals(object other)
        {
            return other is Quaternion && Equals((Quaternion)other);
        }

        public override int GetHashCode()
        {
            return ((x.GetHashCode() * 31 + y.GetHashCode()) * 31 + z.GetHashCode()) * 31 + w.GetHashCode();
        }

        public override string ToString()
        {
            return string.Format(
                CultureInfo.InvariantCulture, "({0:F5}, {1:F5}, {2:F5}, {3:F5})", x, y, z, w);
        }

        private static float Positive(float degrees)
        {
            return degrees < -0.0001F ? degrees + 360F : degrees;
        }

        /// <summary>From the columns of a rotation matrix.</summary>
        private static Quaternion FromAxes(Vector3 x, Vector3 y, Vector3 z)
        {
            float trace = x.x + y.y + z.z;
            if (trace > 0F)
            {
                float s = Mathf.Sqrt(trace + 1F) * 2F;
                return new Quaternion((y.z - z.y) / s, (z.x - x.z) / s, (x.y - y.x) / s, s / 4F);
            }
            if (x.x > y.y && x.x > z.z)
            {
                float s = Mathf.Sqrt(1F + x.x - y.y - z.z) * 2F;
                return new Quaternion(s / 4F, (y.x + x.y) / s, (z.x + x.z) / s, (y.z - z.y) / s);
            }
            if (y.y > z.z)
            {
                float s = Mathf.Sqrt(1F + y.y - x.x - z.z) * 2F;
                return new Quaternion((y.x + x.y) / s, s / 4F, (z.y + y.z) / s, (z.x - x.z) / s);
            }
            float last = Mathf.Sqrt(1F + z.z - x.x - y.y) * 2F;
            return new Quaternion((z.x + x.z) / last, (z.y + y.z) / last, last / 4F, (x.y - y.x) / last);
        }
    }
}

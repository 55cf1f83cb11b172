// Of UnityEngine the members that packaging/unity uses, as its manual says that they behave:
// vectors. Nothing here is Unity's code.
using System;

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }

        public static Vector3 one { get { return new Vector3(1, 1, 1); } }
        public static Vector3 zero { get { return new Vector3(0, 0, 0); } }
        public float magnitude { get { return (float)Math.Sqrt(Dot(this, this)); } }

        public static Vector3 Min(Vector3 a, Vector3 b)
        {
            return new Vector3(Math.Min(a.x, b.x), Math.Min(a.y, b.y), Math.Min(a.z, b.z));
        }

        public static Vector3 Max(Vector3 a, Vector3 b) { return -1.0f * Min(-1.0f * a, -1.0f * b); }

        public static float Dot(Vector3 a, Vector3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

        public static Vector3 Cross(Vector3 a, Vector3 b)
        {
            return new Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                               a.x * b.y - a.y * b.x);
        }

        public static Vector3 operator +(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
        }

        public static Vector3 operator -(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);
        }

        public static Vector3 operator *(float s, Vector3 a)
        {
            return new Vector3(s * a.x, s * a.y, s * a.z);
        }

        public override string ToString() { return "(" + x + ", " + y + ", " + z + ")"; }
    }

    public struct Quaternion
    {
        public float x, y, z, w;

        public Quaternion(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }

        public static Quaternion identity { get { return new Quaternion(0, 0, 0, 1); } }

        public static Quaternion Inverse(Quaternion q)
        {
            return new Quaternion(-q.x, -q.y, -q.z, q.w);
        }

        public static Vector3 operator *(Quaternion q, Vector3 v)
        {
            Vector3 axis = new Vector3(q.x, q.y, q.z);
            Vector3 once = Vector3.Cross(axis, v);
            return v + 2.0f * (q.w * once + Vector3.Cross(axis, once));
        }
    }

    public struct Color
    {
        public float r, g, b, a;
        public static Color red { get { return new Color { r = 1, a = 1 }; } }
    }

    public struct Bounds
    {
        public Vector3 center, extents;
    }

    public struct Ray
    {
        public Vector3 origin, direction;

        public Ray(Vector3 origin, Vector3 direction)
        {
            this.origin = origin;
            this.direction = (1.0f / direction.magnitude) * direction;
        }
    }

    public struct RaycastHit
    {
        public Vector3 point;
    }

    public static class Mathf
    {
        public static float MoveTowards(float from, float to, float most)
        {
            return Math.Abs(to - from) <= most ? to : from + Math.Sign(to - from) * most;
        }
    }
}

namespace UnityEngine.Rendering
{
    public enum IndexFormat
    {
        UInt16,
        UInt32
    }
}

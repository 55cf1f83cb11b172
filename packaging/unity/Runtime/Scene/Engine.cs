using UnityEngine;

namespace Palpate.Unity
{
    /// <summary>Between the library's values and the engine's: axes by Axes, doubles and
    /// floats.</summary>
    public static class Engine
    {
        /// <summary>Of a point, a displacement, a normal, a force.</summary>
        public static Vector3 ToEngine(Vector3d v)
        {
            Vector3d turned = Axes.Vector(v);
            return new Vector3((float)turned.X, (float)turned.Y, (float)turned.Z);
        }

        public static Vector3d ToLibrary(Vector3 v)
        {
            return Axes.Vector(new Vector3d(v.x, v.y, v.z));
        }

        public static Vector3 TorqueToEngine(Vector3d torque)
        {
            Vector3d turned = Axes.Turning(torque);
            return new Vector3((float)turned.X, (float)turned.Y, (float)turned.Z);
        }

        public static Quaternion ToEngine(Quaterniond q)
        {
            Quaterniond turned = Axes.Rotation(q);
            return new Quaternion((float)turned.X, (float)turned.Y, (float)turned.Z,
                                  (float)turned.W);
        }

        public static Quaterniond ToLibrary(Quaternion q)
        {
            return Axes.Rotation(new Quaterniond(q.x, q.y, q.z, q.w));
        }
    }
}

using System;

namespace Palpate
{
    /// <summary>
    /// The one place where axes are converted. The library's frames are right-handed, z up in
    /// its examples; Unity's are left-handed, y up. Their x axes agree, and y and z change
    /// places: (x, y, z) here is (x, z, y) there. Nothing is mirrored in space: the same point
    /// has other coordinates. Each function is its own inverse.
    /// </summary>
    public static class Axes
    {
        /// <summary>Of a point, a displacement, a normal, a force.</summary>
        public static Vector3d Vector(Vector3d v) { return new Vector3d(v.X, v.Z, v.Y); }

        /// <summary>Of what a cross product gives: a torque, an angular velocity.</summary>
        public static Vector3d Turning(Vector3d v) { return new Vector3d(-v.X, -v.Z, -v.Y); }

        /// <summary>Of an orientation, whose axis is a Turning() vector; zeros stay zeros.
        /// </summary>
        public static Quaterniond Rotation(Quaterniond q)
        {
            return new Quaterniond(-q.X, -q.Z, -q.Y, q.W);
        }

        public static ToolPose Pose(ToolPose pose)
        {
            return new ToolPose(Vector(pose.Position), Rotation(pose.Rotation));
        }

        public static Wrench Wrench(Wrench wrench)
        {
            return new Wrench
            {
                Force = Vector(wrench.Force),
                Torque = Turning(wrench.Torque)
            };
        }

        /// <summary>Of triangles, in place: their front faces stay outside, anticlockwise in
        /// the library, clockwise in Unity.</summary>
        public static void Triangles(Span<int> corners)
        {
            for (int i = 0; i + 2 < corners.Length; i += 3)
            {
                int second = corners[i + 1];
                corners[i + 1] = corners[i + 2];
                corners[i + 2] = second;
            }
        }
    }
}

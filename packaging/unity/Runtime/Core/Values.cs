// What goes through the C interface, in the layout of the headers palpate*.h, whose comments
// hold here.
using System;
using System.Runtime.InteropServices;

namespace Palpate
{
    /// <summary>A point, force or torque.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Vector3d : IEquatable<Vector3d>
    {
        public double X, Y, Z;

        public Vector3d(double x, double y, double z)
        {
            X = x;
            Y = y;
            Z = z;
        }

        public double Length { get { return Math.Sqrt(Dot(this, this)); } }

        public static double Dot(Vector3d a, Vector3d b)
        {
            return a.X * b.X + a.Y * b.Y + a.Z * b.Z;
        }

        /// <summary>By the components' formula, whatever hand the axes have.</summary>
        public static Vector3d Cross(Vector3d a, Vector3d b)
        {
            return new Vector3d(a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z,
                                a.X * b.Y - a.Y * b.X);
        }

        public static Vector3d operator +(Vector3d a, Vector3d b)
        {
            return new Vector3d(a.X + b.X, a.Y + b.Y, a.Z + b.Z);
        }

        public static Vector3d operator -(Vector3d a, Vector3d b)
        {
            return new Vector3d(a.X - b.X, a.Y - b.Y, a.Z - b.Z);
        }

        public static Vector3d operator *(double s, Vector3d a)
        {
            return new Vector3d(s * a.X, s * a.Y, s * a.Z);
        }

        public bool Equals(Vector3d other)
        {
            return X.Equals(other.X) && Y.Equals(other.Y) && Z.Equals(other.Z);
        }

        public override bool Equals(object other)
        {
            return other is Vector3d && Equals((Vector3d)other);
        }

        public override int GetHashCode()
        {
            return X.GetHashCode() ^ (3 * Y.GetHashCode()) ^ (7 * Z.GetHashCode());
        }

        public override string ToString() { return "(" + X + ", " + Y + ", " + Z + ")"; }
    }

    /// <summary>An orientation, of any length; zeros: none.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Quaterniond
    {
        public double X, Y, Z, W;

        public Quaterniond(double x, double y, double z, double w)
        {
            X = x;
            Y = y;
            Z = z;
            W = w;
        }

        public static Quaterniond Identity { get { return new Quaterniond(0, 0, 0, 1); } }

        /// <summary>The vector turned by it, by the formula of unit quaternions.</summary>
        public static Vector3d operator *(Quaterniond q, Vector3d v)
        {
            double squared = q.X * q.X + q.Y * q.Y + q.Z * q.Z + q.W * q.W;
            Vector3d axis = new Vector3d(q.X, q.Y, q.Z);
            Vector3d once = Vector3d.Cross(axis, v);
            return v + (2.0 / squared) * (q.W * once + Vector3d.Cross(axis, once));
        }
    }

    /// <summary>Where a hand's tool is: palpate_pose.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ToolPose
    {
        /// <summary>[host length] of the tool's reference point.</summary>
        public Vector3d Position;
        public Quaterniond Rotation;

        public ToolPose(Vector3d position, Quaterniond rotation = default(Quaterniond))
        {
            Position = position;
            Rotation = rotation;
        }
    }

    /// <summary>On a hand's tool: palpate_hand_wrench.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Wrench
    {
        public Vector3d Force;   // [host force]
        public Vector3d Torque;  // [host force x host length] about the reference point
    }

    /// <summary>Below zero a fault: the force is zero until Tool.Reset().</summary>
    public enum Status
    {
        Free = 0,
        Contact = 1,
        NotFinite = -1,
        TimeStep = -2,
        Energy = -3,
        SlowStalled = -4,
        Internal = -101,
        Input = -102,
        Format = -103
    }

    [Flags]
    public enum BodyFlags : uint
    {
        None = 0,
        OwnSlowSteps = 1,
        LimitStiffness = 2,
        Streamed = 4,
        Scene = 8,
        Estimate = 16,
        ForcesAlone = 32
    }

    public enum Answer
    {
        None = 0,
        Estimated = 1,
        Preliminary = 2,
        Final = 3
    }

    public enum ServiceState
    {
        None = 0,
        Joining = 1,
        Serving = 2,
        Silent = 3,
        Lost = 4,
        Nonsense = 5,
        Other = 6,
        Done = 7,
        Failed = 8
    }

    // palpate_options; BodyOptions is what callers fill in.
    [StructLayout(LayoutKind.Sequential)]
    internal struct NativeOptions
    {
        public UIntPtr StructSize;
        public IntPtr ToolName;
        public double MetresPerUnit;
        public double NewtonsPerUnit;
        public double PositionGain;
        public double ForceGain;
        public double NominalTickS;
        public double SlowHz;
        public double DeviceDampingNSPerM;
        public double DeviceDelayS;
        public double ForceMaxN;
        public double StallS;
        public double RampS;
        public uint Flags;
        public IntPtr Model;
        public double DeviceAngularDampingNMS;
        public IntPtr Server;
        public IntPtr Output;
    }

    /// <summary>The latest tick: palpate_state.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct ToolState
    {
        internal UIntPtr StructSize;
        public Status Status;
        public int Triangle;
        public Vector3d ContactPoint;
        public Vector3d Normal;
        public Vector3d Force;
        public double Depth;
        public double WorkJ;
        public double StoredJ;
        public double TankJ;
        public double DissipatedJ;
        public double RestOffset;
        public double ForceScale;
        public double TiltRad;
        public int Starved;
        public int Extrapolated;
        public ulong Ticks;
        public double MemoryJ;
        public double RelaxedForce;
        public double YieldedJ;
        public double Dent;
        public Vector3d Torque;
        public int Contacts;
        public int CouplingScaled;
        public Vector3d SecondForce;
        public Vector3d SecondTorque;
        public Answer Answer;
    }

    /// <summary>A contact of a tool, to be drawn: palpate_contact.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Contact
    {
        public int Hand;
        public int Table;
        public int Touching;
        public int Triangle;
        public double Radius;
        public Vector3d Centre;
        public Vector3d Point;
        public Vector3d Normal;
        public Vector3d Force;
        public double Depth;
        public double OwnDepth;
        public Vector3d Shares;
    }

    /// <summary>A needle's latest tick: palpate_needle.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct NeedleState
    {
        internal UIntPtr StructSize;
        public int Channels;
        public int Channel;
        public ulong Broken;
        public ulong Refused;
        public double TipDepth;
        public double Inserted;
        public double TipForce;
        public double ShaftForce;
        public Vector3d LateralForce;
        public double CutJ;
        public double ReleasedJ;
        public double ShaftJ;
    }

    /// <summary>What a needle has cut open: palpate_channel.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Channel
    {
        public Vector3d Entry;
        public Vector3d Axis;
        public double Depth;
        public int Layer;
        public int Layers;
        public double Boundary;
    }

    // palpate_service; Service is what callers get.
    [StructLayout(LayoutKind.Sequential)]
    internal unsafe struct NativeService
    {
        public UIntPtr StructSize;
        public int State;
        public int Started;
        public long Nodes;
        public long Answered;
        public long Finished;
        public long Softened;
        public fixed byte Detail[256];
    }
}

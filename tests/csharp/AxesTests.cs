// What a conversion of axes must keep, whatever it is.
using System;
using System.Linq;
using Palpate;

[Tests]
public static class AxesTests
{
    private static readonly Random Random = new Random(7);

    private static double Number() { return 2.0 * Random.NextDouble() - 1.0; }

    private static Vector3d Any() { return new Vector3d(Number(), Number(), Number()); }

    private static Quaterniond AnyTurn()
    {
        Quaterniond q = new Quaterniond(Number(), Number(), Number(), Number());
        double s = 1.0 / Math.Sqrt(q.X * q.X + q.Y * q.Y + q.Z * q.Z + q.W * q.W);
        return new Quaterniond(s * q.X, s * q.Y, s * q.Z, s * q.W);
    }

    private static void Often(Action check)
    {
        for (int i = 0; i < 100; ++i)
        {
            check();
        }
    }

    public static void UpIsUp()
    {
        Check.Equal(new Vector3d(0, 1, 0), Axes.Vector(new Vector3d(0, 0, 1)));
        Check.Equal(new Vector3d(1, 0, 0), Axes.Vector(new Vector3d(1, 0, 0)));
    }

    public static void TheHandOfTheAxesChanges()
    {
        Vector3d x = Axes.Vector(new Vector3d(1, 0, 0)), y = Axes.Vector(new Vector3d(0, 1, 0));
        Vector3d z = Axes.Vector(new Vector3d(0, 0, 1));
        Check.Equal(-1.0, Vector3d.Dot(Vector3d.Cross(x, y), z));
    }

    public static void ThereAndBackIsNothing()
    {
        Often(() =>
        {
            Vector3d v = Any();
            Quaterniond q = AnyTurn();
            Check.Equal(v, Axes.Vector(Axes.Vector(v)));
            Check.Equal(v, Axes.Turning(Axes.Turning(v)));
            Check.Equal(q, Axes.Rotation(Axes.Rotation(q)));
            ToolPose pose = new ToolPose(v, q);
            Check.Equal(pose, Axes.Pose(Axes.Pose(pose)));
            Wrench wrench = new Wrench { Force = v, Torque = Any() };
            Check.Equal(wrench, Axes.Wrench(Axes.Wrench(wrench)));
        });
        Check.Equal(default(Quaterniond), Axes.Rotation(default(Quaterniond)));
    }

    public static void LengthsAndAnglesStay()
    {
        Often(() =>
        {
            Vector3d a = Any(), b = Any();
            Check.Near(Vector3d.Dot(a, b), Vector3d.Dot(Axes.Vector(a), Axes.Vector(b)), 1e-15);
        });
    }

    public static void ATorqueIsTheArmTimesTheForce()
    {
        Often(() =>
        {
            Vector3d arm = Any(), force = Any();
            Check.Near(Axes.Turning(Vector3d.Cross(arm, force)),
                       Vector3d.Cross(Axes.Vector(arm), Axes.Vector(force)), 1e-15);
        });
    }

    public static void ATurnedVectorIsConvertedEitherWay()
    {
        Often(() =>
        {
            Vector3d v = Any();
            Quaterniond q = AnyTurn();
            Check.Near(Axes.Vector(q * v), Axes.Rotation(q) * Axes.Vector(v), 1e-14);
        });
    }

    public static void AWrenchDoesTheSameWork()
    {
        Often(() =>
        {
            Wrench wrench = new Wrench { Force = Any(), Torque = Any() };
            Wrench there = Axes.Wrench(wrench);
            Vector3d moved = Any(), turned = Any();
            Check.Near(Vector3d.Dot(wrench.Force, moved) + Vector3d.Dot(wrench.Torque, turned),
                       Vector3d.Dot(there.Force, Axes.Vector(moved)) +
                           Vector3d.Dot(there.Torque, Axes.Turning(turned)), 1e-14);
        });
    }

    // Front faces: anticlockwise in right-handed axes, and clockwise in left-handed ones, have
    // the cross product of two sides outside.
    public static void TrianglesKeepTheirOutside()
    {
        int[] corners = { 0, 1, 2, 3, 4, 5 };
        Axes.Triangles(corners);
        Check.Equal("0 2 1 3 5 4", string.Join(" ", corners));
        Often(() =>
        {
            Vector3d[] p = { Any(), Any(), Any() };
            Vector3d normal = Vector3d.Cross(p[1] - p[0], p[2] - p[0]);
            Vector3d[] q = p.Select(Axes.Vector).ToArray();
            int[] one = { 0, 1, 2 };
            Axes.Triangles(one);
            Check.Near(Axes.Vector(normal),
                       Vector3d.Cross(q[one[1]] - q[one[0]], q[one[2]] - q[one[0]]), 1e-14);
        });
    }

    // The same press on a body that stands as the scene says, in either's axes.
    public static void APressIsFeltInTheScenesAxes()
    {
        Quaterniond standing = AnyTurn();
        Vector3d origin = Any();
        using (Body placed = Hand.Open("pads.h5", "pads"))
        using (Body plain = Hand.Open("pads.h5", "pads"))
        using (Tool inScene = placed.AddTool())
        using (Tool inBody = plain.AddTool())
        {
            placed.Place(Axes.Vector(origin), Axes.Rotation(standing));
            Wrench right = default(Wrench), scene = default(Wrench);
            for (int tick = 0; tick < 1000; ++tick)
            {
                // The hand's pose in the body's own frame, then where the scene has it.
                ToolPose local = Hand.At(tick);
                ToolPose world = new ToolPose(
                    origin + standing * Axes.Vector(local.Position),
                    Times(standing, Axes.Rotation(local.Rotation)));
                Wrench made;
                inScene.Step(Axes.Pose(world), 0.001, out made);
                scene = Axes.Wrench(made);
                inBody.Step(local, 0.001, out right);
                placed.SlowStep();
                plain.SlowStep();
            }
            Check.True(right.Force.Z > 0.1 && right.Torque.Length > 1e-5, "no press");
            Check.Near(standing * Axes.Vector(right.Force), scene.Force, 1e-9);
            Check.Near(standing * Axes.Turning(right.Torque), scene.Torque, 1e-9);
        }
    }

    // a after b, by the formula of quaternions.
    private static Quaterniond Times(Quaterniond a, Quaterniond b)
    {
        return new Quaterniond(a.W * b.X + a.X * b.W + a.Y * b.Z - a.Z * b.Y,
                               a.W * b.Y - a.X * b.Z + a.Y * b.W + a.Z * b.X,
                               a.W * b.Z + a.X * b.Y - a.Y * b.X + a.Z * b.W,
                               a.W * b.W - a.X * b.X - a.Y * b.Y - a.Z * b.Z);
    }
}

// Hands that press as host.c does.
using System;
using Palpate;

public static class Hand
{
    public const double RadiusM = 0.005;

    /// <summary>pose_at() of host.c.</summary>
    public static ToolPose At(int tick)
    {
        ToolPose pose = new ToolPose(default(Vector3d), Quaterniond.Identity);
        pose.Position.X = 0.0031 + 1e-6 * tick;
        pose.Position.Y = 0.0017;
        pose.Position.Z = 0.0055 - 3e-6 * (tick < 1000 ? tick : 2000 - tick);
        pose.Rotation.Y = 1e-5 * tick;
        return pose;
    }

    /// <summary>Where a tool of that radius has a depth in the plate.</summary>
    public static Vector3d Over(double depthM, double xM = 0.0031)
    {
        return new Vector3d(xM, 0.0017, RadiusM - depthM);
    }

    /// <summary>From 1 mm above down to a depth in 0.4 s, then half a second of rest.</summary>
    public static Status Press(Body body, Tool tool, double depthM, out Vector3d force)
    {
        Status status = Status.Free;
        force = default(Vector3d);
        for (int tick = 0; tick < 900; ++tick)
        {
            double part = Math.Min(1.0, tick / 400.0);
            status = tool.Force(Over(-0.001 + part * (depthM + 0.001)), 0.001, out force);
            if (tick % 10 == 0)
            {
                body.SlowStep();
            }
        }
        return status;
    }

    public static Body Open(string file, string tool = null)
    {
        return new Body(Given.File(file), Given.OwnSlowSteps(tool));
    }
}

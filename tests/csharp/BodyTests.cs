using System;
using System.IO;
using System.Linq;
using Palpate;

[Tests]
public static class BodyTests
{
    private static void Refused(BodyOptions options, params string[] words)
    {
        Check.Throws<PalpateException>(() => new Body(Given.File("plate.h5"), options), words);
    }

    public static void AMissingFileIsNamed()
    {
        Check.Throws<PalpateException>(() => new Body("/nowhere/liver.h5"), "/nowhere/liver.h5");
        Check.Throws<PalpateException>(() => new Body((string)null), "no file is named");
        Check.Throws<ArgumentException>(() => new Body("a\0b"), "zero character");
    }

    public static void NamesOfFilesAreUtf8()
    {
        string file = Given.File("Leber ü 肝 🫀.h5");
        File.Copy(Given.File("plate.h5"), file, true);
        using (new Body(file, Given.OwnSlowSteps()))
        {
        }
        Check.Throws<PalpateException>(() => new Body(file + "x"), "Leber ü 肝 🫀.h5x");
    }

    // Bytes are pinned where they are read on: many collections move what is not.
    public static void AFileItsFlatFormAndTheirBytesAreOneBody()
    {
        byte[] flat = File.ReadAllBytes(Given.File("plate.palpate"));
        BodyOptions streamed = Given.OwnSlowSteps();
        streamed.Flags |= BodyFlags.Streamed;
        Func<Body>[] ways =
        {
            () => Hand.Open("plate.h5"), () => Hand.Open("plate.palpate"),
            () => new Body(File.ReadAllBytes(Given.File("plate.h5")), Given.OwnSlowSteps()),
            () => new Body((byte[])flat.Clone(), Given.OwnSlowSteps()),
            () => new Body((byte[])flat.Clone(), streamed)
        };
        Vector3d right = default(Vector3d);
        foreach (Func<Body> way in ways)
        {
            using (Body body = way())
            using (Tool tool = body.AddTool())
            {
                GC.Collect();
                GC.Collect();
                Vector3d force;
                Check.Equal(Status.Contact, Hand.Press(body, tool, 0.003, out force));
                right = right.Equals(default(Vector3d)) ? force : right;
                Check.Equal(right, force);
            }
        }
    }

    public static void WrongBytesAreRefused()
    {
        byte[] flat = File.ReadAllBytes(Given.File("plate.palpate"));
        byte[] cut = flat.Take(flat.Length - 1).ToArray();
        BodyOptions streamed = new BodyOptions { Flags = BodyFlags.Streamed };
        Check.Throws<PalpateException>(() => new Body(cut), "truncated");
        Check.Throws<PalpateException>(() => new Body(cut, streamed), "truncated");
        Check.Throws<PalpateException>(() => new Body(new byte[10]), "a response database");
        Check.Throws<PalpateException>(() => new Body(new byte[0]));
        Check.Throws<ArgumentNullException>(() => new Body((byte[])null));
        Check.Throws<PalpateException>(
            () => new Body(flat, new BodyOptions { Flags = BodyFlags.Scene }), "file");
    }

    public static void EachOptionReachesTheLibrary()
    {
        Refused(new BodyOptions { ToolName = "hammer" }, "hammer");
        Refused(new BodyOptions { Model = "jelly" }, "jelly");
        Refused(new BodyOptions { MetresPerUnit = 2e6 }, "unit of length");
        Refused(new BodyOptions { NewtonsPerUnit = -1 }, "unit of force");
        Refused(new BodyOptions { PositionGain = double.NaN }, "position gain");
        Refused(new BodyOptions { ForceGain = 1e7 }, "force gain");
        Refused(new BodyOptions { NominalTickS = 2 }, "nominal tick");
        Refused(new BodyOptions { SlowHz = 0.5 }, "slow rate is 0.5");
        Refused(new BodyOptions { DeviceDampingNSPerM = -1 }, "device damping");
        Refused(new BodyOptions { DeviceDelayS = -1 }, "device delay");
        Refused(new BodyOptions { ForceMaxN = -1 }, "largest force");
        Refused(new BodyOptions { StallS = -1 }, "stall limit");
        Refused(new BodyOptions { RampS = -1 }, "start-up ramp");
        Refused(new BodyOptions { Flags = (BodyFlags)1024 }, "flags");
        Refused(new BodyOptions { DeviceAngularDampingNMS = -1 }, "angular damping");
    }

    // The core alone refuses scenes.
    public static void OptionsOfScenesReachTheLibrary()
    {
        BodyOptions nobody = new BodyOptions
        {
            Flags = BodyFlags.Scene,
            Server = "/nowhere/serve",
            Output = Given.File("out.h5")
        };
        try
        {
            new Body(Given.File("plate.h5"), nobody);
        }
        catch (PalpateException thrown)
        {
            if (thrown.Message.StartsWith("scenes are not rendered"))
            {
                return;
            }
        }
        Refused(nobody, "/nowhere/serve");
        Refused(new BodyOptions { Flags = BodyFlags.Scene, Server = Given.File("serve"),
                                  Output = Given.File("organ.h5") }, "exit code 0");
        string arguments = File.ReadAllText(Given.File("arguments.txt"));
        Check.True(arguments.Contains(Given.File("organ.h5")), arguments);
    }

    public static void ABodyTooStiffIsRefusedOrSoftened()
    {
        Refused(new BodyOptions { DeviceDampingNSPerM = 0.01 }, "stiff");
        BodyOptions soft = new BodyOptions
        {
            DeviceDampingNSPerM = 0.01,
            Flags = BodyFlags.LimitStiffness | BodyFlags.OwnSlowSteps
        };
        using (Body body = new Body(Given.File("plate.h5"), soft))
        using (Tool tool = body.AddTool())
        {
            ToolState state;
            tool.State(out state);
            Check.True(state.ForceScale < 1.0 && state.ForceScale > 0.0, "not softened");
        }
    }

    public static void TheNeededDampingIsKHalfT()
    {
        using (Body body = Hand.Open("plate.h5"))
        {
            // 2 N at 10 mm stick by mu N / delta_L = 0.3 * 2 / 5e-4 N/m, which is the largest.
            Check.Near(1200 * 0.001 / 2, body.NeededDamping, 1e-9);
        }
        BodyOptions slower = Given.OwnSlowSteps();
        slower.NominalTickS = 0.002;
        slower.DeviceDelayS = 0.0005;
        using (Body body = new Body(Given.File("plate.h5"), slower))
        {
            Check.Near(1200 * (0.002 / 2 + 0.0005), body.NeededDamping, 1e-9);
        }
    }

    public static void TheMeshIsThePlate()
    {
        using (Body body = Hand.Open("plate.h5"))
        {
            Check.Equal(121, body.VertexCount);
            Check.Equal(200, body.TriangleCount);
            Vector3d[] vertices = new Vector3d[121];
            int[] corners = new int[600];
            body.Mesh(vertices, corners);
            body.Mesh(Span<Vector3d>.Empty, corners);
            body.Mesh(vertices, Span<int>.Empty);
            Check.Equal(0.05, vertices.Max(v => v.X));
            Check.Equal(0.0, vertices.Max(v => Math.Abs(v.Z)));
            Vector3d a = vertices[corners[0]];
            Vector3d normal = Vector3d.Cross(vertices[corners[1]] - a, vertices[corners[2]] - a);
            Check.True(normal.Z > 0.0, "anticlockwise from above");
            Check.Throws<ArgumentException>(() => body.Mesh(new Vector3d[120], corners), "121");
            Check.Throws<ArgumentException>(() => body.Mesh(vertices, new int[7]), "600");
        }
    }

    public static void AStreamedBodyHasNoMesh()
    {
        BodyOptions options = Given.OwnSlowSteps();
        options.Flags |= BodyFlags.Streamed;
        using (Body body = new Body(Given.File("plate.h5"), options))
        {
            Check.Equal(0, body.VertexCount);
            Check.Throws<PalpateException>(() => body.Mesh(Span<Vector3d>.Empty, Span<int>.Empty),
                                           "streamed");
        }
    }

    public static void QueriesAreOfRest()
    {
        using (Body body = Hand.Open("plate.h5"))
        {
            Vector3d[] forces = new Vector3d[2];
            body.Query(new[] { Hand.Over(0.003), Hand.Over(-0.001) }, forces);
            Check.Near(new Vector3d(0, 0, 0.18), forces[0], 1e-9);
            Check.Equal(default(Vector3d), forces[1]);
            Check.Throws<ArgumentException>(() => body.Query(new Vector3d[3], forces), "3");
            Check.Throws<PalpateException>(
                () => body.Query(new[] { new Vector3d(double.NaN, 0, 0), Hand.Over(0) }, forces));
            body.Query(ReadOnlySpan<Vector3d>.Empty, Span<Vector3d>.Empty);
        }
    }

    public static void APlacedBodyIsFeltWhereItStands()
    {
        using (Body body = Hand.Open("plate.h5"))
        using (Tool tool = body.AddTool())
        {
            // Half a turn about x: the outside is below.
            body.Place(new Vector3d(0, 0, 1), new Quaterniond(2, 0, 0, 0));
            Vector3d force;
            Status status = Status.Free;
            for (int tick = 0; tick < 500; ++tick)
            {
                double depthM = Math.Min(0.002, 1e-5 * (tick - 100));
                Vector3d at = new Vector3d(0.0031, -0.0017, 1 - (Hand.RadiusM - depthM));
                status = tool.Force(at, 0.001, out force);
                body.SlowStep();
            }
            ToolState state;
            tool.State(out state);
            Check.Equal(Status.Contact, status);
            Check.Near(new Vector3d(0, 0, -0.08), state.Force, 1e-3);
            Check.Near(new Vector3d(0, 0, -1), state.Normal, 1e-12);
            Vector3d[] vertices = new Vector3d[body.VertexCount];
            body.Mesh(vertices, Span<int>.Empty);
            Check.Near(1.0, vertices[0].Z, 1e-12);
            Check.Throws<PalpateException>(
                () => body.Place(default(Vector3d), default(Quaterniond)), "orientation");
            Check.Throws<PalpateException>(
                () => body.Place(new Vector3d(double.PositiveInfinity, 0, 0),
                                 Quaterniond.Identity), "finite");
        }
    }

    public static void SlowStepsAreTheHostsOrTheLibrarys()
    {
        using (Body body = Hand.Open("plate.h5"))
        {
            Check.Equal(0, body.SlowStep());  // no tool
            Check.Equal(null, body.SlowFailure);
        }
        using (Body body = new Body(Given.File("plate.h5")))
        {
            Check.Throws<PalpateException>(() => body.SlowStep(), "slow steps of the host's");
        }
    }

    public static void ADatabaseHasNoService()
    {
        using (Body body = Hand.Open("plate.h5"))
        {
            Service service = body.Service;
            Check.Equal(ServiceState.None, service.State);
            Check.Equal("", service.Detail);
            Check.Equal(0L, service.Nodes);
        }
    }

    public static void ABodyTakesSixteenTools()
    {
        using (Body body = Hand.Open("plate.h5"))
        {
            for (int i = 0; i < 16; ++i)
            {
                body.AddTool().Dispose();
            }
            Check.Throws<PalpateException>(() => body.AddTool(), "16 tools");
        }
    }

    public static void StatusesHaveTheLibrarysNames()
    {
        Check.Equal("contact", Library.NameOf(Status.Contact));
        Check.Equal("not-finite", Library.NameOf(Status.NotFinite));
        Library.LockHdf5();
        Library.UnlockHdf5();
    }
}

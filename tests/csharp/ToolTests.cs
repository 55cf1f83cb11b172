using System;
using System.Linq;
using Palpate;

[Tests]
public static class ToolTests
{
    private static string Bits(Vector3d v)
    {
        return string.Join(" ", new[] { v.X, v.Y, v.Z }.Select(
            each => BitConverter.DoubleToInt64Bits(each).ToString("x16")));
    }

    private static void SamePath(string file, string name)
    {
        string[] host = Given.Host("path", Given.File(file), name);
        int touched = 0;
        using (Body body = Hand.Open(file, name))
        using (Tool tool = body.AddTool())
        {
            for (int tick = 0; tick < 2000; ++tick)
            {
                if (tick % 10 == 0)
                {
                    body.SlowStep();
                }
                Wrench made;
                Status status = tool.Step(Hand.At(tick), 0.001, out made);
                touched += status == Status.Contact ? 1 : 0;
                Check.Equal(host[tick],
                            (int)status + " " + Bits(made.Force) + " " + Bits(made.Torque));
            }
        }
        Check.True(touched > 1000, "touched in " + touched + " ticks");
    }

    public static void ForcesAreCsToTheBit() { SamePath("plate.h5", "ball"); }

    public static void TorquesAreCsToTheBit() { SamePath("pads.h5", "pads"); }

    public static void ForcesAreTheSameAfterDents() { SamePath("dents.h5", "ball"); }

    public static void TheAccountCloses()
    {
        using (Body body = Hand.Open("dents.h5"))
        using (Tool tool = body.AddTool())
        {
            Vector3d force;
            Check.Equal(Status.Contact, Hand.Press(body, tool, 0.003, out force));
            Check.Near(0.18, force.Z, 1e-6);
            ToolState state;
            tool.State(out state);
            Check.Equal(900UL, state.Ticks);
            Check.Equal(force, state.Force);
            Check.Near(0.003, state.Depth, 1e-12);
            Check.Near(0.0008, state.Dent, 1e-9);
            Check.True(state.YieldedJ > 0.0 && state.WorkJ > 0.0, "no work");
            Check.Near(state.WorkJ,
                       state.StoredJ + state.TankJ + state.DissipatedJ + state.MemoryJ, 1e-12);
            Check.Equal(Answer.Final, state.Answer);
        }
    }

    public static void ANanIsALatchedFault()
    {
        using (Body body = Hand.Open("plate.h5"))
        using (Tool tool = body.AddTool())
        {
            Vector3d force;
            Hand.Press(body, tool, 0.003, out force);
            Check.Equal(Status.NotFinite,
                        tool.Force(new Vector3d(0, double.NaN, 0), 0.001, out force));
            Check.Equal(default(Vector3d), force);
            Check.Equal(Status.NotFinite, tool.Force(Hand.Over(0.003), 0.001, out force));
            tool.Reset();
            Check.Equal(Status.Contact, Hand.Press(body, tool, 0.003, out force));
            Check.Equal(Status.TimeStep, tool.Force(Hand.Over(0.003), 1.5, out force));
        }
    }

    public static void WhatIsDeliveredIsAccounted()
    {
        using (Body body = Hand.Open("plate.h5"))
        using (Tool tool = body.AddTool())
        {
            Vector3d force;
            Hand.Press(body, tool, 0.003, out force);
            Check.True(tool.Delivered(new[] { 0.5 * force }, Span<Vector3d>.Empty), "refused");
            Vector3d[] nan = { new Vector3d(double.NaN, 0, 0) };
            Check.True(!tool.Delivered(nan, Span<Vector3d>.Empty), "took NaN");
            Check.Throws<ArgumentException>(
                () => tool.Delivered(new Vector3d[2], Span<Vector3d>.Empty), "forces: 2");
        }
    }

    public static void EveryFormOfAStepIsTheSame()
    {
        using (Body body = Hand.Open("pads.h5", "pads"))
        using (Tool one = body.AddTool())
        using (Tool many = body.AddTool())
        using (Tool parts = body.AddTool())
        {
            ToolPose[] poses = new ToolPose[1];
            Wrench[] wrenches = new Wrench[1];
            for (int tick = 0; tick < 1000; ++tick)
            {
                body.SlowStep();
                Wrench made;
                Vector3d force, torque;
                poses[0] = Hand.At(tick);
                one.Step(poses[0], 0.001, out made);
                many.Step(poses, 0.001, wrenches);
                parts.Wrench(poses[0].Position, poses[0].Rotation, 0.001, out force, out torque);
                Check.Equal(made, wrenches[0]);
                Check.Equal(made.Force, force);
                Check.Equal(made.Torque, torque);
            }
            Check.True(wrenches[0].Torque.Length > 0.0, "no torque");
            Check.Throws<ArgumentException>(() => one.Step(new ToolPose[2], 0.001, wrenches), "2");
            Check.Throws<ArgumentException>(() => one.Step(poses, 0.001, new Wrench[3]), "3");
            Check.Throws<ArgumentException>(
                () => one.Together(new Vector3d[2], Span<Quaterniond>.Empty, 0.001,
                                   new Vector3d[2], Span<Vector3d>.Empty), "hands");
        }
    }

    public static void TwoHandsFeelEachOther()
    {
        using (Body body = Hand.Open("pads.h5", "ball"))
        using (Tool pair = body.AddTogether())
        {
            Vector3d[] at = new Vector3d[2], forces = new Vector3d[2], torques = new Vector3d[2];
            Quaterniond[] turned = { Quaterniond.Identity, Quaterniond.Identity };
            Status status = Status.Free;
            for (int tick = 0; tick <= 1000; ++tick)
            {
                double z = 0.003 + 1e-5 * (1000 - tick);
                at[0] = new Vector3d(-0.006, 0.002, z);
                at[1] = new Vector3d(0.008, 0.002, z);
                status = pair.Together(at, turned, 0.001, forces, torques);
                body.SlowStep();
            }
            Check.Equal(Status.Contact, status);
            Check.True(forces[0].Z > 0.0 && forces[0].Z < 0.95 * 2e4 * 4e-6, "alone");
            Check.Near(forces[0].Z, forces[1].Z, 1e-3 * forces[0].Z);
            ToolState state;
            pair.State(out state);
            Check.Equal(forces[1], state.SecondForce);
            Wrench[] wrenches = new Wrench[2];
            Check.Equal(Status.Contact,
                        pair.Step(new[] { new ToolPose(at[0]), new ToolPose(at[1]) }, 0.001,
                                  wrenches));
            Wrench made;
            Check.Throws<ArgumentException>(
                () => pair.Step(new ToolPose(at[0]), 0.001, out made), "2 would be right");
            Check.Throws<PalpateException>(() => body.AddTogether("hammer"), "hammer");
        }
        using (Body body = Hand.Open("plate.h5"))
        {
            Check.Throws<PalpateException>(() => body.AddTogether());  // no table
        }
    }

    public static void ContactsAndTheDeformedSurface()
    {
        using (Body body = Hand.Open("pads.h5", "pads"))
        using (Tool tool = body.AddTool())
        {
            for (int tick = 0; tick < 1000; ++tick)
            {
                Wrench made;
                tool.Step(Hand.At(tick), 0.001, out made);
                body.SlowStep();
            }
            Contact[] contacts = new Contact[64];
            Check.Equal(3, tool.Contacts(new Contact[1]));
            Check.Equal(3, tool.Contacts(Span<Contact>.Empty));
            Check.Equal(3, tool.Contacts(contacts));
            Check.Equal(Hand.RadiusM, contacts[0].Radius);
            ToolState state;
            tool.State(out state);
            Vector3d sum = contacts[0].Force + contacts[1].Force + contacts[2].Force;
            Check.Near(state.Force, sum, 1e-9);
            Vector3d[] moved = new Vector3d[body.VertexCount];
            Check.Equal(3, tool.Displaced(new ReadOnlySpan<Contact>(contacts, 0, 3), moved));
            // Each sinks all by a millimetre a 4 mm of its own depth.
            double sunkM = (contacts[0].OwnDepth + contacts[1].OwnDepth + contacts[2].OwnDepth) / 4;
            Check.Near(new Vector3d(0, 0, -sunkM), moved[7], 1e-6 * sunkM);
            Check.Throws<ArgumentException>(
                () => tool.Displaced(contacts, new Vector3d[3]), "displacements");
            contacts[0].Table = 7;
            Check.Throws<PalpateException>(
                () => tool.Displaced(new ReadOnlySpan<Contact>(contacts, 0, 3), moved), "table 7");
        }
    }

    public static void ANeedleCutsAChannel()
    {
        using (Body body = Hand.Open("needle.h5"))
        using (Tool tool = body.AddTool())
        {
            for (int i = 0; i <= 1600; ++i)
            {
                Vector3d force;
                tool.Force(new Vector3d(0.001, 0.002, 0.0005 + 0.002 - 1e-5 * i), 0.001, out force);
                body.SlowStep();
            }
            NeedleState needle;
            Check.True(tool.Needle(out needle), "no needle");
            Check.Equal(1, needle.Channels);
            Check.Equal(2UL, needle.Broken);
            Check.Near(0.014, needle.TipDepth, 1e-4);
            Channel[] channels = new Channel[16];
            Check.Equal(1, tool.Channels(channels));
            Check.Equal(1, tool.Channels(Span<Channel>.Empty));
            Check.Near(1.0, channels[0].Axis.Z, 1e-12);
            Check.Near(0.001, channels[0].Entry.X, 1e-4);
        }
        using (Body body = Hand.Open("plate.h5"))
        using (Tool tool = body.AddTool())
        {
            NeedleState needle;
            Check.True(!tool.Needle(out needle), "a ball is no needle");
            Check.Throws<PalpateException>(() => tool.Channels(new Channel[1]), "needle");
        }
    }

    public static void DentsOutliveTheTool()
    {
        string surface = Given.File("surface ü.h5");
        Vector3d force, again;
        using (Body body = Hand.Open("dents.h5"))
        using (Tool tool = body.AddTool())
        {
            Hand.Press(body, tool, 0.003, out force);
            tool.SaveSurface(surface);
            tool.Reset();
            Hand.Press(body, tool, 0.002, out again);
            Check.True(again.Z < 0.8 * 2e4 * 4e-6, "no dent");
            tool.LoadSurface(null);
            Hand.Press(body, tool, 0.002, out force);
            Check.Near(2e4 * 4e-6, force.Z, 1e-6);
            Check.Throws<PalpateException>(() => tool.SaveSurface("/nowhere/s.h5"), "/nowhere/s.h5");
            Check.Throws<PalpateException>(() => tool.LoadSurface("/nowhere/s.h5"), "/nowhere/s.h5");
            Check.Throws<PalpateException>(() => tool.SaveSurface(null), "null");
        }
        using (Body body = Hand.Open("dents.h5"))
        using (Tool tool = body.AddTool())
        {
            tool.LoadSurface(surface);
            Hand.Press(body, tool, 0.002, out force);
            Check.Equal(again, force);
        }
    }
}

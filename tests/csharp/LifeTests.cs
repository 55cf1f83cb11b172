// Handles: disposal in any order, finalizers, threads, and steps that allocate nothing.
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.IO;
using System.Runtime.CompilerServices;
using System.Threading;
using Palpate;

[Tests]
public static class LifeTests
{
    // Mono does not count threads that it did not make.
    private static int Threads
    {
        get
        {
            return Given.Windows ? Process.GetCurrentProcess().Threads.Count
                                 : Directory.GetDirectories("/proc/self/task").Length;
        }
    }

    private static void WaitUntil(Func<bool> holds, string what)
    {
        for (int i = 0; i < 500 && !holds(); ++i)
        {
            Thread.Sleep(10);
        }
        Check.True(holds(), what);
    }

    public static void AToolKeepsItsBodyAlive()
    {
        Body body = Hand.Open("plate.h5");
        Tool tool = body.AddTool();
        Vector3d before, after;
        Hand.Press(body, tool, 0.003, out before);
        body.Dispose();
        Check.Equal(Status.Contact, tool.Force(Hand.Over(0.003), 0.001, out after));
        Check.Near(before, after, 1e-9);
        Check.Throws<ObjectDisposedException>(() => body.AddTool());
        Check.Throws<ObjectDisposedException>(() => body.SlowStep());
        tool.Dispose();
        Check.Throws<ObjectDisposedException>(() => tool.Force(Hand.Over(0), 0.001, out after));
    }

    public static void DisposedInAnyOrderAndTwice()
    {
        for (int order = 0; order < 6; ++order)
        {
            Body body = new Body(Given.File("plate.h5"));
            IDisposable[] all = { body, body.AddTool(), body.AddTool() };
            int first = order / 2, second = (first + 1 + order % 2) % 3;
            all[first].Dispose();
            all[second].Dispose();
            all[3 - first - second].Dispose();
            all[first].Dispose();
        }
    }

    public static void EveryFunctionRefusesADisposedHandle()
    {
        Body body = Hand.Open("plate.h5");
        Tool tool = body.AddTool();
        tool.Dispose();
        body.Dispose();
        Vector3d v = default(Vector3d);
        Wrench w;
        ToolState state;
        NeedleState needle;
        Vector3d[] one = new Vector3d[1];
        Action[] calls =
        {
            () => body.AddTogether(), () => v.X = body.NeededDamping, () => body.Service.ToString(),
            () => body.Place(default(Vector3d), Quaterniond.Identity),
            () => v.X = body.VertexCount, () => body.Query(one, one),
            () => body.SlowFailure.ToString(), () => body.Mesh(one, new int[3]),
            () => tool.Step(default(ToolPose), 0, out w), () => tool.State(out state),
            () => tool.Step(new ToolPose[1], 0, new Wrench[1]),
            () => tool.Wrench(v, Quaterniond.Identity, 0, out v, out v),
            () => tool.Delivered(one, one), () => tool.Contacts(new Contact[1]),
            () => tool.Displaced(new Contact[1], new Vector3d[121]),
            () => tool.Needle(out needle), () => tool.Channels(new Channel[1]),
            () => tool.Reset(), () => tool.SaveSurface("x"), () => tool.LoadSurface(null)
        };
        foreach (Action call in calls)
        {
            Check.Throws<ObjectDisposedException>(call);
        }
    }

    [MethodImpl(MethodImplOptions.NoInlining)]
    private static void Forget(int bodies)
    {
        for (int i = 0; i < bodies; ++i)
        {
            Body body = new Body(Given.File("plate.h5"));
            body.AddTool();
            body.AddTool();
        }
    }

    public static void ForgottenBodiesAreFinalized()
    {
        int before = Threads;
        Thread forgetful = new Thread(() => Forget(10));  // nothing of it stays on this stack
        forgetful.Start();
        forgetful.Join();
        Check.True(Threads >= before + 8, "each body has a slow thread");
        WaitUntil(() =>
        {
            GC.Collect();
            GC.WaitForPendingFinalizers();
            return Threads <= before + 2;  // Mono's collector may have left one stack unread
        }, "slow threads run on");
    }

    public static void TwoToolsInTwoThreads()
    {
        using (Body body = new Body(Given.File("plate.h5")))
        {
            List<string> wrong = new List<string>();
            Thread[] threads = new Thread[2];
            for (int i = 0; i < threads.Length; ++i)
            {
                double x = 0.01 * i;
                Tool tool = body.AddTool();
                threads[i] = new Thread(() =>
                {
                    string fault = PressInRealTime(tool, x);
                    tool.Dispose();
                    lock (wrong)
                    {
                        wrong.AddRange(fault == null ? new string[0] : new[] { fault });
                    }
                });
                threads[i].Start();
            }
            Array.ForEach(threads, each => each.Join());
            Check.Equal("", string.Join(", ", wrong));
        }
    }

    private static string PressInRealTime(Tool tool, double x)
    {
        Vector3d force = default(Vector3d);
        Status status = Status.Free;
        for (int tick = 0; tick < 500; ++tick)
        {
            status = tool.Force(Hand.Over(Math.Min(0.002, 1e-5 * (tick - 100)), x), 0.001,
                                out force);
            Thread.Sleep(1);
        }
        return status == Status.Contact && Math.Abs(force.Z - 0.08) < 1e-3
            ? null
            : Library.NameOf(status) + " " + force;
    }

    public static void DisposingDuringAStepWaitsForIt()
    {
        for (int i = 0; i < 20; ++i)
        {
            Body body = Hand.Open("plate.h5");
            Tool tool = body.AddTool();
            Thread stepping = new Thread(() =>
            {
                try
                {
                    Vector3d force;
                    while (tool.Force(Hand.Over(0.001), 0.001, out force) >= Status.SlowStalled)
                    {
                    }
                }
                catch (ObjectDisposedException)
                {
                }
            });
            stepping.Start();
            Thread.Sleep(i % 4);
            tool.Dispose();
            body.Dispose();
            stepping.Join();
        }
    }

    public static void AMillionStepsAllocateNothing()
    {
        using (Body body = Hand.Open("pads.h5", "pads"))
        using (Tool tool = body.AddTool())
        {
            Contact[] contacts = new Contact[3];
            Vector3d[] delivered = new Vector3d[1];
            ToolPose[] poses = new ToolPose[1];
            Wrench[] wrenches = new Wrench[1];
            Steps(body, tool, 2000, contacts, delivered, poses, wrenches);
            long before = GC.GetAllocatedBytesForCurrentThread();
            int collections = GC.CollectionCount(0);
            Steps(body, tool, 1000000, contacts, delivered, poses, wrenches);
            Check.Equal(0L, GC.GetAllocatedBytesForCurrentThread() - before);
            Check.Equal(0, GC.CollectionCount(0) - collections);
        }
    }

    private static void Steps(Body body, Tool tool, int count, Contact[] contacts,
                              Vector3d[] delivered, ToolPose[] poses, Wrench[] wrenches)
    {
        for (int tick = 0; tick < count; ++tick)
        {
            Wrench made;
            ToolState state;
            NeedleState needle;
            poses[0] = Hand.At(tick % 2000);
            tool.Step(poses[0], 0.001, out made);
            delivered[0] = made.Force;
            tool.Delivered(delivered, ReadOnlySpan<Vector3d>.Empty);
            tool.State(out state);
            if (tick % 10 == 0)
            {
                body.SlowStep();
                tool.Step(poses, 0.001, wrenches);
                tool.Contacts(contacts);
                tool.Needle(out needle);
            }
        }
    }
}

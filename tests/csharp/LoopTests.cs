// The haptic thread, and what passes between it and the thread that draws.
using System;
using System.Threading;
using Palpate;

[Tests]
public static class LoopTests
{
    private sealed class Numbers
    {
        public readonly long[] Values = new long[64];
    }

    private sealed class Device : IHapticDevice
    {
        public double DepthM = -0.001;
        public int Reads, Zeros;
        public Wrench Last;
        public string Throws;
        public HapticLoop Stops;

        public ToolPose Read()
        {
            ++Reads;
            if (Stops != null)
            {
                Stops.Stop();
            }
            if (Throws != null)
            {
                throw new InvalidOperationException(Throws);
            }
            return new ToolPose(Hand.Over(Volatile.Read(ref DepthM)));
        }

        public void Write(Wrench wrench)
        {
            Last = wrench;
            Zeros = wrench.Force.Length == 0.0 ? Zeros + 1 : 0;
        }
    }

    private static void WaitUntil(Func<bool> holds, string what)
    {
        for (int i = 0; i < 1000 && !holds(); ++i)
        {
            Thread.Sleep(5);
        }
        Check.True(holds(), what);
    }

    public static void AnExchangedValueIsWholeAndTheLatest()
    {
        const int Count = 200000;
        Exchange<Numbers> exchange = new Exchange<Numbers>();
        Thread writer = new Thread(() =>
        {
            for (long n = 1; n <= Count; ++n)
            {
                long[] back = exchange.Back.Values;
                for (int i = 0; i < back.Length; ++i)
                {
                    back[i] = n;
                }
                exchange.Publish();
            }
        });
        writer.Start();
        long last = 0;
        while (last < Count)
        {
            long[] latest = exchange.Latest().Values;
            long first = latest[0];
            Check.True(first >= last, "an older value");
            Check.Equal(first, latest[63]);
            Check.True(Array.TrueForAll(latest, each => each == first), "torn");
            last = first;
        }
        writer.Join();
        Check.Equal((long)Count, exchange.Latest().Values[5]);
    }

    public static void AFollowerIsALowPass()
    {
        ToolPose zero = new ToolPose(default(Vector3d), Quaterniond.Identity);
        Follower follower = new Follower(zero, 0.02, 0.001);
        Check.Equal(zero, follower.Next());
        follower.Lead(new ToolPose(new Vector3d(1, 0, 0), new Quaterniond(0, 0, 0, -1)));
        ToolPose pose = zero;
        for (int i = 0; i < 20; ++i)
        {
            pose = follower.Next();
        }
        Check.Near(1 - Math.Exp(-1), pose.Position.X, 1e-12);
        Check.Near(1.0, pose.Rotation.W, 1e-12);  // -q is q
        Follower stiff = new Follower(zero, 0.0, 0.001);
        stiff.Lead(new ToolPose(new Vector3d(0, 3, 0)));
        Check.Equal(3.0, stiff.Next().Position.Y);
        Check.Throws<ArgumentException>(() => new Follower(zero, double.NaN, 0.001), "NaN");
    }

    public static void ALoopStepsInAThreadOfItsOwn()
    {
        Device device = new Device();
        using (Body body = new Body(Given.File("plate.h5")))
        using (Tool tool = body.AddTool())
        using (HapticLoop loop = new HapticLoop(tool, device, 1000.0, true))
        {
            loop.Start();
            loop.Start();  // once is enough
            WaitUntil(() => device.Reads > 100, "no ticks");
            Volatile.Write(ref device.DepthM, 0.001);
            WaitUntil(() => loop.Latest().Status == Status.Contact &&
                            loop.Latest().Wrench.Force.Z > 0.0199, "no contact");
            HapticFrame frame = loop.Latest();
            Check.Near(0.02, frame.State.Force.Z, 1e-4);
            Check.Equal(1, frame.ContactCount);
            Check.Equal(1, frame.Contacts[0].Touching);
            Check.True(frame.LongestGapS > 0.0005, "gap " + frame.LongestGapS);
            loop.Stop();
            Check.Equal(default(Wrench), device.Last);
            Check.Equal(null, loop.Failure);
            int reads = device.Reads;
            Thread.Sleep(20);
            Check.Equal(reads, device.Reads);
            loop.Start();
            WaitUntil(() => device.Reads > reads + 50, "does not go on");
        }
        Check.Equal(default(Wrench), device.Last);
    }

    public static void AFaultIsZeroUntilAReset()
    {
        Device device = new Device { DepthM = double.NaN };
        using (Body body = new Body(Given.File("plate.h5")))
        using (Tool tool = body.AddTool())
        using (HapticLoop loop = new HapticLoop(tool, device, 1000.0, true))
        {
            loop.Start();
            WaitUntil(() => loop.Latest().Status == Status.NotFinite, "no fault");
            Volatile.Write(ref device.DepthM, 0.001);
            WaitUntil(() => device.Zeros > 20, "a force");
            Check.Equal(Status.NotFinite, loop.Latest().Status);
            loop.Reset();
            WaitUntil(() => loop.Latest().Status == Status.Contact, "still a fault");
        }
    }

    public static void ADeviceThatThrowsEndsTheLoopWithZeros()
    {
        Device device = new Device { Throws = "unplugged" };
        using (Body body = new Body(Given.File("plate.h5")))
        using (Tool tool = body.AddTool())
        using (HapticLoop loop = new HapticLoop(tool, device))
        {
            loop.Start();
            WaitUntil(() => loop.Failure != null, "goes on");
            Check.Equal("unplugged", loop.Failure);
            Check.True(!loop.Running && device.Zeros == 2, "zeros " + device.Zeros);
            device.Throws = null;
            loop.Start();
            WaitUntil(() => device.Reads > 20, "does not start anew");
            Check.Equal(null, loop.Failure);
            device.Stops = loop;
            WaitUntil(() => !loop.Running, "a device cannot stop it");
            Check.Throws<ArgumentException>(() => new HapticLoop(tool, device, 1e5), "10000");
            Check.Throws<ArgumentNullException>(() => new HapticLoop(tool, null));
        }
    }
}

using System;
using System.Diagnostics;
using System.Globalization;
using System.Threading;
using Palpate;

/// <summary>What a step costs from C and from C#, by turns; and how even a loop's ticks are.
/// </summary>
public static class StepSpeed
{
    private const int Count = 1000000;

    public static int Print()
    {
        Once("plate.h5");
        foreach (string file in new[] { "plate.h5", "dents.h5" })
        {
            double c = double.MaxValue, managed = double.MaxValue;
            for (int i = 0; i < 7; ++i)
            {
                string[] host = Given.Host("speed", Given.File(file), Count.ToString());
                c = Math.Min(c, double.Parse(host[0], CultureInfo.InvariantCulture));
                managed = Math.Min(managed, Once(file));
            }
            Console.WriteLine(string.Format(
                CultureInfo.InvariantCulture,
                "{0}: C {1:F0} ns, C# {2:F0} ns a step, ratio {3:F3} (best of 7 of {4} steps)", file,
                c, managed, managed / c, Count));
        }
        Loop(false);
        Loop(true);
        return 0;
    }

    private sealed class Still : IHapticDevice
    {
        public ToolPose Read() { return new ToolPose(Hand.Over(0.002)); }

        public void Write(Wrench wrench) { }
    }

    // Five seconds, with a second thread that draws 100 frames a second, or also makes garbage.
    private static void Loop(bool garbage)
    {
        int collections = GC.CollectionCount(0), kept = 0;
        using (Body body = new Body(Given.File("plate.h5")))
        using (Tool tool = body.AddTool())
        using (HapticLoop loop = new HapticLoop(tool, new Still()))
        {
            loop.Start();
            for (int frame = 0; frame < 500; ++frame)
            {
                Thread.Sleep(10);
                loop.Latest();
                for (int i = 0; garbage && i < 1000; ++i)
                {
                    kept += new object[20].Length;
                }
            }
            HapticFrame last = loop.Latest();
            Console.WriteLine(string.Format(
                CultureInfo.InvariantCulture,
                "loop{0}: {1} ticks in 5 s, longest gap {2:F2} ms, {3} collections",
                garbage ? " beside garbage" : "", last.State.Ticks, 1e3 * last.LongestGapS,
                GC.CollectionCount(0) - collections));
        }
    }

    // print_speed() of host.c.
    private static double Once(string file)
    {
        using (Body body = Hand.Open(file))
        using (Tool tool = body.AddTool())
        {
            Wrench made;
            ToolPose pose = default(ToolPose);
            for (int tick = 0; tick < 2000; ++tick)
            {
                pose = Hand.At(Math.Min(tick, 1000));
                if (tick % 10 == 0)
                {
                    body.SlowStep();
                }
                tool.Step(pose, 0.001, out made);
            }
            Stopwatch watch = Stopwatch.StartNew();
            for (int tick = 0; tick < Count; ++tick)
            {
                pose.Position.X += tick % 2 == 0 ? 1e-6 : -1e-6;
                tool.Step(pose, 0.001, out made);
            }
            return 1e9 * watch.Elapsed.TotalSeconds / Count;
        }
    }
}

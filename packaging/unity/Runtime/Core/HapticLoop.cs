using System;
using System.Diagnostics;
using System.Threading;

namespace Palpate
{
    /// <summary>What a haptic loop moves. Both functions are called in the haptic thread: they
    /// call no engine, wait for nothing and allocate nothing.</summary>
    public interface IHapticDevice
    {
        ToolPose Read();

        /// <summary>Zeros before the loop's first tick, on a fault, and as its last act.</summary>
        void Write(Wrench wrench);
    }

    /// <summary>A tick, to be drawn.</summary>
    public sealed class HapticFrame
    {
        public Status Status;
        public ToolPose Pose;
        public Wrench Wrench;
        public ToolState State;
        /// <summary>Of these the first ContactCount.</summary>
        public readonly Contact[] Contacts = new Contact[64];
        public int ContactCount;
        /// <summary>[s] the longest time between two ticks since the start: a pause of the
        /// garbage collector, or of the system, in which the device held its force.</summary>
        public double LongestGapS;
    }

    /// <summary>
    /// Steps a tool of one hand in a thread of its own, 1000 times a second. The device holds a
    /// force for that time T, and must damp more than K T/2 (Body.NeededDamping). From Update(),
    /// at 90 Hz, eleven times as much would be needed.
    /// </summary>
    public sealed class HapticLoop : IDisposable
    {
        private readonly Tool tool;
        private readonly IHapticDevice device;
        private readonly long period;
        private readonly bool sleeps;
        private readonly Exchange<HapticFrame> frames = new Exchange<HapticFrame>();
        private Thread thread;
        private volatile bool running;
        private volatile bool resets;
        private volatile string failure;
        private double longestGapS;

        /// <param name="hz">[Hz] (0, 10000] ticks a second.</param>
        /// <param name="sleeps">Gives the processor away between ticks, for pictures without a
        /// device: systems sleep for 1 to 16 ms. Else the thread spins, and takes a whole
        /// processor.</param>
        public HapticLoop(Tool tool, IHapticDevice device, double hz = 1000.0,
                          bool sleeps = false)
        {
            if (tool == null || device == null)
            {
                throw new ArgumentNullException(tool == null ? "tool" : "device");
            }
            if (!(hz > 0.0 && hz <= 10000.0))
            {
                throw new ArgumentException("hz is " + hz + ", must be above 0, at most 10000");
            }
            this.tool = tool;
            this.device = device;
            this.sleeps = sleeps;
            period = (long)(Stopwatch.Frequency / hz);
        }

        /// <summary>Of one thread, that which draws: the latest tick, until the next call.
        /// </summary>
        public HapticFrame Latest() { return frames.Latest(); }

        /// <summary>What ended the thread; null while it is well.</summary>
        public string Failure { get { return failure; } }

        public bool Running { get { return running; } }

        /// <summary>Nothing where it runs already; anew where a failure ended it.</summary>
        public void Start()
        {
            if (running)
            {
                return;
            }
            Stop();
            failure = null;
            longestGapS = 0.0;
            running = true;
            thread = new Thread(Run);
            thread.IsBackground = true;
            thread.Name = "palpate haptic loop";
            thread.Priority = ThreadPriority.Highest;
            thread.Start();
        }

        /// <summary>Waits for the tick that is under way. The device has got zeros then. A device
        /// that calls it gets them after its own tick.</summary>
        public void Stop()
        {
            running = false;
            if (thread != null && thread != Thread.CurrentThread)
            {
                thread.Join();
                thread = null;
            }
        }

        /// <summary>Before the next tick: Tool.Reset(), after a fault.</summary>
        public void Reset() { resets = true; }

        public void Dispose() { Stop(); }

        private void Run()
        {
            try
            {
                device.Write(default(Wrench));
                Tick(0.0);
                long last = Stopwatch.GetTimestamp();
                long due = last + period;
                while (running)
                {
                    long now = Stopwatch.GetTimestamp();
                    if (now < due)
                    {
                        Wait();
                        continue;
                    }
                    double dtS = (now - last) / (double)Stopwatch.Frequency;
                    last = now;
                    due = Math.Max(due + period, now);  // what is missed is not made up for
                    longestGapS = Math.Max(longestGapS, dtS);
                    Tick(dtS);
                }
            }
            catch (Exception thrown)
            {
                failure = thrown.Message;
            }
            finally
            {
                running = false;
                Relax();
            }
        }

        private void Wait()
        {
            if (sleeps)
            {
                Thread.Sleep(1);
            }
            else
            {
                Thread.SpinWait(20);
            }
        }

        private void Tick(double dtS)
        {
            if (resets)
            {
                resets = false;
                tool.Reset();
            }
            HapticFrame frame = frames.Back;
            frame.Pose = device.Read();
            frame.Status = tool.Step(frame.Pose, dtS, out frame.Wrench);
            device.Write(frame.Wrench);
            tool.State(out frame.State);
            frame.ContactCount = Math.Min(tool.Contacts(frame.Contacts), frame.Contacts.Length);
            frame.LongestGapS = longestGapS;
            frames.Publish();
        }

        private void Relax()
        {
            try
            {
                device.Write(default(Wrench));
            }
            catch (Exception thrown)
            {
                failure = failure ?? thrown.Message;
            }
        }
    }
}

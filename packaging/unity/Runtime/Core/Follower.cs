using System;

namespace Palpate
{
    /// <summary>
    /// A pose that follows another one, which comes at a display's rate from another thread:
    /// first-order low-pass, tick by tick. Without it a tool would leap from frame to frame.
    /// </summary>
    public sealed class Follower
    {
        private sealed class Target
        {
            public bool Set;
            public ToolPose Pose;
        }

        private readonly Exchange<Target> targets = new Exchange<Target>();
        private readonly double share;
        private ToolPose pose;

        /// <param name="followS">[s] >= 0 time constant; 0: none.</param>
        /// <param name="tickS">[s] > 0 of Next().</param>
        public Follower(ToolPose start, double followS, double tickS)
        {
            if (!(followS >= 0.0 && tickS > 0.0))
            {
                throw new ArgumentException("times are " + followS + " s and " + tickS +
                                            " s, must not be negative, the tick not 0");
            }
            pose = start;
            share = followS > 0.0 ? 1.0 - Math.Exp(-tickS / followS) : 1.0;
        }

        /// <summary>Of one thread.</summary>
        public void Lead(ToolPose to)
        {
            targets.Back.Pose = to;
            targets.Back.Set = true;
            targets.Publish();
        }

        /// <summary>Of one other thread: the pose one tick later.</summary>
        public ToolPose Next()
        {
            Target target = targets.Latest();
            if (target.Set)
            {
                pose.Position = pose.Position + share * (target.Pose.Position - pose.Position);
                pose.Rotation = Between(pose.Rotation, target.Pose.Rotation, share);
            }
            return pose;
        }

        // Along the chord, on the side of the sphere that is nearer; of any length.
        private static Quaterniond Between(Quaterniond a, Quaterniond b, double part)
        {
            double dot = a.X * b.X + a.Y * b.Y + a.Z * b.Z + a.W * b.W;
            double to = dot < 0.0 ? -part : part;
            double from = 1.0 - part;
            return new Quaterniond(from * a.X + to * b.X, from * a.Y + to * b.Y,
                                   from * a.Z + to * b.Z, from * a.W + to * b.W);
        }
    }
}

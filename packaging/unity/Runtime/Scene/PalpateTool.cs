using System;
using UnityEngine;

namespace Palpate.Unity
{
    /// <summary>
    /// A tool of a body, stepped 1000 times a second in a thread of its own. Without a device
    /// the tool follows this transform, smoothed: for mice and pictures. With one, the device's
    /// pose leads, and this transform shows it. Update() only draws.
    /// </summary>
    [AddComponentMenu("palpate/Tool")]
    public sealed class PalpateTool : MonoBehaviour
    {
        public PalpateBody body;
        [Tooltip("[Hz] ticks a second.")]
        public double rateHz = 1000.0;
        [Tooltip("[s] in which the tool follows the transform, without a device.")]
        public double followS = 0.02;

        private readonly Contact[] one = new Contact[1];
        private Adapter adapter;
        private HapticFrame frame = new HapticFrame();
        private HapticLoop loop;
        private Tool tool;

        /// <summary>In the engine's axes and this scene's units. Set it before this component
        /// is enabled; null: none.</summary>
        public IHapticDevice Device { get; set; }

        /// <summary>On the tool, in the world's axes.</summary>
        public Vector3 Force { get { return Engine.ToEngine(frame.Wrench.Force); } }

        /// <summary>On the tool, about its reference point, in the world's axes.</summary>
        public Vector3 Torque { get { return Engine.TorqueToEngine(frame.Wrench.Torque); } }

        public Status Status { get { return frame.Status; } }

        /// <summary>The latest tick, in the library's axes.</summary>
        public HapticFrame Frame { get { return frame; } }

        /// <summary>[scene's length] of the tool's sphere, or of its first one.</summary>
        public float Radius { get; private set; }

        /// <summary>After a fault, before the next tick.</summary>
        public void ResetFault()
        {
            if (loop != null)
            {
                loop.Reset();
            }
        }

        internal void Pause()
        {
            if (loop != null)
            {
                loop.Stop();
            }
        }

        internal void Continue()
        {
            if (loop != null)
            {
                loop.Start();
            }
        }

        internal int Displaced(Vector3d[] moved)
        {
            if (tool == null || frame.Status != Status.Contact)
            {
                return 0;
            }
            return tool.Displaced(
                new ReadOnlySpan<Contact>(frame.Contacts, 0, frame.ContactCount), moved);
        }

        private void OnEnable()
        {
            try
            {
                Open();
            }
            catch (Exception thrown)
            {
                Debug.LogError("palpate: " + name + ": " + thrown.Message, this);
                OnDisable();
            }
        }

        private void OnDisable()
        {
            if (loop != null)
            {
                loop.Dispose();
                loop = null;
                frame = new HapticFrame();
            }
            if (tool != null)
            {
                body.Remove(this);
                tool.Dispose();
                tool = null;
            }
        }

        private void Update()
        {
            if (loop == null)
            {
                return;
            }
            if (loop.Failure != null)
            {
                Debug.LogError("palpate: " + name + ": " + loop.Failure, this);
                OnDisable();
                return;
            }
            frame = loop.Latest();
            if (Device == null)
            {
                adapter.Lead(Here());
            }
            else
            {
                transform.position = Engine.ToEngine(frame.Pose.Position);
                transform.rotation = Engine.ToEngine(frame.Pose.Rotation);
            }
        }

        private void Open()
        {
            if (body == null || body.Body == null)
            {
                throw new PalpateException("its body is not set, or could not be opened");
            }
            tool = body.Body.AddTool();
            body.Add(this);
            tool.Contacts(one);
            Radius = (float)one[0].Radius;
            frame = new HapticFrame();
            adapter = new Adapter(Device, Here(), followS, 1.0 / rateHz);
            loop = new HapticLoop(tool, adapter, rateHz, Device == null);
            loop.Start();
        }

        private ToolPose Here()
        {
            return new ToolPose(Engine.ToLibrary(transform.position),
                                Engine.ToLibrary(transform.rotation));
        }

        // What the haptic thread asks, in the library's axes.
        private sealed class Adapter : IHapticDevice
        {
            private readonly IHapticDevice device;
            private readonly Follower follower;

            public Adapter(IHapticDevice device, ToolPose start, double followS, double tickS)
            {
                this.device = device;
                follower = new Follower(start, followS, tickS);
            }

            public void Lead(ToolPose pose) { follower.Lead(pose); }

            public ToolPose Read()
            {
                return device == null ? follower.Next() : Axes.Pose(device.Read());
            }

            public void Write(Wrench wrench)
            {
                if (device != null)
                {
                    device.Write(Axes.Wrench(wrench));
                }
            }
        }
    }
}

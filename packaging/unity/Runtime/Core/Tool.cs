using System;
using System.Runtime.InteropServices;

namespace Palpate
{
    /// <summary>
    /// A tool of a body, which it keeps alive until it is disposed. One thread at a time uses
    /// it, the haptic one. What is for that thread says so: it allocates nothing.
    /// </summary>
    public sealed unsafe class Tool : IDisposable
    {
        private static readonly UIntPtr Room = (UIntPtr)Text.Room;
        private readonly ToolHandle handle;
        private readonly int vertices;

        internal Tool(ToolHandle handle, int hands, int vertices)
        {
            this.handle = handle;
            this.vertices = vertices;
            Hands = hands;
        }

        /// <summary>1, or 2 of Body.AddTogether().</summary>
        public int Hands { get; private set; }

        /// <summary>Haptic thread: one tick of a tool of one hand.</summary>
        /// <param name="dtS">[s] since the last call, at most 1; 0: the nominal tick.</param>
        /// <param name="wrench">Zero in free space and on a fault.</param>
        public Status Step(ToolPose pose, double dtS, out Wrench wrench)
        {
            Lengths.Require("poses", 1, Hands, false);
            Wrench made;
            int status = Native.palpate_step(handle, &pose, (UIntPtr)1, dtS, &made);
            wrench = made;
            return (Status)status;
        }

        /// <summary>Haptic thread: one tick, of each hand a pose in and a wrench out.</summary>
        public Status Step(ReadOnlySpan<ToolPose> poses, double dtS, Span<Wrench> wrenches)
        {
            Lengths.Require("poses", poses.Length, Hands, false);
            Lengths.Require("wrenches", wrenches.Length, Hands, false);
            fixed (ToolPose* at = &MemoryMarshal.GetReference(poses))
            fixed (Wrench* made = &MemoryMarshal.GetReference(wrenches))
            {
                return (Status)Native.palpate_step(handle, at, (UIntPtr)Hands, dtS, made);
            }
        }

        /// <summary>Haptic thread: one tick of one hand that feels no torque.</summary>
        public Status Force(Vector3d position, Quaterniond rotation, double dtS,
                            out Vector3d force)
        {
            Lengths.Require("positions", 1, Hands, false);
            Vector3d made;
            int status = Native.palpate_force(handle, &position, &rotation, dtS, &made);
            force = made;
            return (Status)status;
        }

        /// <summary>Haptic thread: the same without an orientation.</summary>
        public Status Force(Vector3d position, double dtS, out Vector3d force)
        {
            return Force(position, default(Quaterniond), dtS, out force);
        }

        /// <summary>Haptic thread: Step() of one hand.</summary>
        public Status Wrench(Vector3d position, Quaterniond rotation, double dtS,
                             out Vector3d force, out Vector3d torque)
        {
            Lengths.Require("positions", 1, Hands, false);
            Vector3d f, t;
            int status = Native.palpate_wrench(handle, &position, &rotation, dtS, &f, &t);
            force = f;
            torque = t;
            return (Status)status;
        }

        /// <summary>Haptic thread: Step() of two hands.</summary>
        /// <param name="rotations">Two, or none.</param>
        /// <param name="torques">Two, or none: no torque is felt.</param>
        public Status Together(ReadOnlySpan<Vector3d> positions,
                               ReadOnlySpan<Quaterniond> rotations, double dtS,
                               Span<Vector3d> forces, Span<Vector3d> torques)
        {
            Lengths.Require("hands of the tool", Hands, 2, false);
            Lengths.Require("positions", positions.Length, 2, false);
            Lengths.Require("rotations", rotations.Length, 2, true);
            Lengths.Require("forces", forces.Length, 2, false);
            Lengths.Require("torques", torques.Length, 2, true);
            fixed (Vector3d* at = &MemoryMarshal.GetReference(positions))
            fixed (Quaterniond* turned = &MemoryMarshal.GetReference(rotations))
            fixed (Vector3d* f = &MemoryMarshal.GetReference(forces))
            fixed (Vector3d* t = &MemoryMarshal.GetReference(torques))
            {
                return (Status)Native.palpate_together(handle, at, turned, dtS, f, t);
            }
        }

        /// <summary>Haptic thread, between two ticks: what the device made of the latest force
        /// and torque, where that is not what was asked for.</summary>
        /// <param name="forces">One for each hand.</param>
        /// <param name="torques">One for each hand, or none: as they were asked for.</param>
        /// <returns>False where one is not finite, which changes nothing.</returns>
        public bool Delivered(ReadOnlySpan<Vector3d> forces, ReadOnlySpan<Vector3d> torques)
        {
            Lengths.Require("forces", forces.Length, Hands, false);
            Lengths.Require("torques", torques.Length, Hands, true);
            fixed (Vector3d* f = &MemoryMarshal.GetReference(forces))
            fixed (Vector3d* t = &MemoryMarshal.GetReference(torques))
            {
                return Native.palpate_delivered(handle, f, t) == 0;
            }
        }

        /// <summary>The haptic thread, or one other, but always the same one.</summary>
        public void State(out ToolState state)
        {
            ToolState all = default(ToolState);
            all.StructSize = (UIntPtr)sizeof(ToolState);
            Native.palpate_state_get(handle, &all);
            state = all;
        }

        /// <summary>Haptic thread, outside a tick: the contacts of the latest tick, as many as
        /// there is room for.</summary>
        /// <returns>How many there are, 1 to 64, whatever the room.</returns>
        public int Contacts(Span<Contact> contacts)
        {
            fixed (Contact* all = &MemoryMarshal.GetReference(contacts))
            {
                return Native.palpate_contacts_get(handle, all, (UIntPtr)contacts.Length,
                                                   (UIntPtr)sizeof(Contact));
            }
        }

        /// <summary>Any thread: by how much the surface deforms under those contacts.</summary>
        /// <param name="displacements">One for each vertex of the body.</param>
        /// <returns>How many contacts have fields; 0 where the database stores none.</returns>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public int Displaced(ReadOnlySpan<Contact> contacts, Span<Vector3d> displacements)
        {
            Lengths.Require("displacements", displacements.Length, vertices, false);
            byte[] why = new byte[Text.Room];
            fixed (Contact* all = &MemoryMarshal.GetReference(contacts))
            fixed (Vector3d* moved = &MemoryMarshal.GetReference(displacements))
            fixed (byte* error = why)
            {
                return Known(Native.palpate_displaced(handle, all, (UIntPtr)contacts.Length,
                                                      (UIntPtr)sizeof(Contact), moved, error,
                                                      Room), why);
            }
        }

        /// <summary>Haptic thread, outside a tick.</summary>
        /// <returns>False where the tool is no needle.</returns>
        public bool Needle(out NeedleState needle)
        {
            NeedleState all = default(NeedleState);
            all.StructSize = (UIntPtr)sizeof(NeedleState);
            bool well = Native.palpate_needle_get(handle, &all, null, UIntPtr.Zero) == 0;
            needle = all;
            return well;
        }

        /// <summary>Not in the haptic thread: what a needle has cut open, as many channels as
        /// there is room for.</summary>
        /// <returns>How many there are, 0 to 16, whatever the room.</returns>
        /// <exception cref="PalpateException">The tool is no needle.</exception>
        public int Channels(Span<Channel> channels)
        {
            byte[] why = new byte[Text.Room];
            fixed (Channel* all = &MemoryMarshal.GetReference(channels))
            fixed (byte* error = why)
            {
                return Known(Native.palpate_channels_get(handle, all, (UIntPtr)channels.Length,
                                                         (UIntPtr)sizeof(Channel), error, Room),
                             why);
            }
        }

        /// <summary>While no other call of the tool is under way: palpate_reset().</summary>
        public void Reset() { Native.palpate_reset(handle); }

        /// <summary>While no other call of the tool is under way: what stays of its presses.
        /// </summary>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public void SaveSurface(string file)
        {
            byte[] why = new byte[Text.Room];
            fixed (byte* name = Text.ToNative(file), error = why)
            {
                Known(Native.palpate_surface_save(handle, name, error, Room), why);
            }
        }

        /// <summary>While no other call of the tool is under way: Reset() on a body that has
        /// yielded as a file says.</summary>
        /// <param name="file">Null: a fresh one.</param>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public void LoadSurface(string file)
        {
            byte[] why = new byte[Text.Room];
            fixed (byte* name = Text.ToNative(file), error = why)
            {
                Known(Native.palpate_surface_load(handle, name, error, Room), why);
            }
        }

        /// <summary>Lets the body go. The library frees the tool with it.</summary>
        public void Dispose() { handle.Dispose(); }

        private static int Known(int count, byte[] why)
        {
            if (count < 0)
            {
                throw new PalpateException(Text.FromNative(why));
            }
            return count;
        }
    }
}

using System;
using System.Runtime.InteropServices;

namespace Palpate
{
    /// <summary>The library as a whole.</summary>
    public static class Library
    {
        /// <summary>PALPATE_ABI_VERSION that these files are written for.</summary>
        public const int AbiVersion = 1;

        /// <exception cref="PalpateException">The library has another version.</exception>
        public static void RequireVersion()
        {
            int version = Native.palpate_abi_version();
            if (version != AbiVersion)
            {
                throw new PalpateException("the library palpate has ABI version " + version +
                                           ", these C# files are for " + AbiVersion);
            }
        }

        /// <summary>"free", "contact", "not-finite", ... Any thread; allocates.</summary>
        public static string NameOf(Status status)
        {
            return Marshal.PtrToStringAnsi(Native.palpate_fault_name((int)status));
        }

        /// <summary>For a host that calls HDF5 itself: palpate_hdf5_lock().</summary>
        public static void LockHdf5() { Native.palpate_hdf5_lock(); }

        public static void UnlockHdf5() { Native.palpate_hdf5_unlock(); }
    }

    /// <summary>palpate_options: null and zero mean the default.</summary>
    public sealed class BodyOptions
    {
        /// <summary>Null: the database's only tool.</summary>
        public string ToolName;
        /// <summary>[m] host's unit of length; 1.</summary>
        public double MetresPerUnit;
        /// <summary>[N] host's unit of force; 1.</summary>
        public double NewtonsPerUnit;
        /// <summary>[-] movement here per device movement; 1.</summary>
        public double PositionGain;
        /// <summary>[-] device force per force given here; 1.</summary>
        public double ForceGain;
        /// <summary>[s] what a time step of 0 means; 0.001.</summary>
        public double NominalTickS;
        /// <summary>[Hz] of the slow process; 100.</summary>
        public double SlowHz;
        /// <summary>[N s/m] viscous; 0: unknown, no bound is checked.</summary>
        public double DeviceDampingNSPerM;
        /// <summary>[s] from command to force; 0.</summary>
        public double DeviceDelayS;
        /// <summary>[N] at the device; 8.</summary>
        public double ForceMaxN;
        /// <summary>[s] in contact without an element: fault; 0.5.</summary>
        public double StallS;
        /// <summary>[s] from start or reset to the full force; 0.1.</summary>
        public double RampS;
        public BodyFlags Flags;
        /// <summary>Local model; null: "potential".</summary>
        public string Model;
        /// <summary>[N m s] viscous, of turns; 0: unknown.</summary>
        public double DeviceAngularDampingNMS;
        /// <summary>Of a scene: the program palpate-precompute.</summary>
        public string Server;
        /// <summary>Of a scene: the database that is computed.</summary>
        public string Output;

        internal unsafe NativeOptions Filled(byte* tool, byte* model, byte* server,
                                              byte* output)
        {
            return new NativeOptions
            {
                StructSize = (UIntPtr)sizeof(NativeOptions),
                ToolName = (IntPtr)tool,
                MetresPerUnit = MetresPerUnit,
                NewtonsPerUnit = NewtonsPerUnit,
                PositionGain = PositionGain,
                ForceGain = ForceGain,
                NominalTickS = NominalTickS,
                SlowHz = SlowHz,
                DeviceDampingNSPerM = DeviceDampingNSPerM,
                DeviceDelayS = DeviceDelayS,
                ForceMaxN = ForceMaxN,
                StallS = StallS,
                RampS = RampS,
                Flags = (uint)Flags,
                Model = (IntPtr)model,
                DeviceAngularDampingNMS = DeviceAngularDampingNMS,
                Server = (IntPtr)server,
                Output = (IntPtr)output
            };
        }
    }

    /// <summary>How the service of a scene is: palpate_service.</summary>
    public struct Service
    {
        public ServiceState State;
        public bool Started;
        public long Nodes, Answered, Finished, Softened;
        public string Detail;
    }

    /// <summary>
    /// A response database, or a scene, that tools touch. It ends when it and all of its tools
    /// are disposed, in any order. No function of it is for the haptic thread.
    /// </summary>
    public sealed unsafe class Body : IDisposable
    {
        private static readonly UIntPtr Room = (UIntPtr)Text.Room;
        private readonly BodyHandle handle;
        private volatile bool disposed;

        /// <param name="file">Its name, in any letters.</param>
        /// <param name="options">Null: every default.</param>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public Body(string file, BodyOptions options = null)
        {
            handle = Opened(file, null, options ?? new BodyOptions());
        }

        /// <param name="bytes">Of a database: a flat file, or HDF5. With BodyFlags.Streamed the
        /// body holds the array, which must stay as it is.</param>
        /// <param name="options">Null: every default.</param>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public Body(byte[] bytes, BodyOptions options = null)
        {
            if (bytes == null)
            {
                throw new ArgumentNullException("bytes");
            }
            handle = Opened(null, bytes, options ?? new BodyOptions());
        }

        /// <summary>One for each tool of the host, at most 16 of a body; a disposed one counts.
        /// </summary>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public Tool AddTool()
        {
            byte[] why = new byte[Text.Room];
            fixed (byte* error = why)
            {
                return Opened(Native.palpate_tool_open(Open, error, Room), why, 1);
            }
        }

        /// <summary>Two hands that feel each other through the body.</summary>
        /// <param name="second">The second hand's tool; null: another of the same kind.</param>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public Tool AddTogether(string second = null)
        {
            byte[] why = new byte[Text.Room];
            fixed (byte* name = Text.ToNative(second), error = why)
            {
                return Opened(Native.palpate_together_open(Open, name, error, Room), why, 2);
            }
        }

        /// <summary>[N s/m] that the device must have at least: K (T/2 + delay).</summary>
        public double NeededDamping { get { return Native.palpate_needed_damping(Open); } }

        /// <summary>How the body stands in the world; not while a tool steps.</summary>
        /// <exception cref="PalpateException">Not finite, or no orientation.</exception>
        public void Place(Vector3d position, Quaterniond rotation)
        {
            if (Native.palpate_place(Open, &position, &rotation) != 0)
            {
                throw new PalpateException(
                    "a place must be finite, and its orientation not zero; nothing changed");
            }
        }

        /// <summary>0 of a streamed body.</summary>
        public int VertexCount { get { return Count(false); } }

        /// <summary>0 of a streamed body.</summary>
        public int TriangleCount { get { return Count(true); } }

        /// <summary>The surface at rest.</summary>
        /// <param name="vertices">VertexCount, or none.</param>
        /// <param name="corners">Three for each triangle, or none; anticlockwise from outside,
        /// in right-handed axes.</param>
        /// <exception cref="PalpateException">Of a streamed body.</exception>
        public void Mesh(Span<Vector3d> vertices, Span<int> corners)
        {
            Lengths.Require("vertices", vertices.Length, VertexCount, true);
            Lengths.Require("corners", corners.Length, 3 * TriangleCount, true);
            fixed (Vector3d* v = &MemoryMarshal.GetReference(vertices))
            fixed (int* c = &MemoryMarshal.GetReference(corners))
            {
                if (Native.palpate_mesh_get(Open, v, c) != 0)
                {
                    throw new PalpateException("a streamed body has no surface in memory");
                }
            }
        }

        /// <summary>Forces on the tool at rest at positions, each by itself.</summary>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public void Query(ReadOnlySpan<Vector3d> positions, Span<Vector3d> forces)
        {
            Lengths.Require("forces", forces.Length, positions.Length, false);
            byte[] why = new byte[Text.Room];
            fixed (Vector3d* at = &MemoryMarshal.GetReference(positions))
            fixed (Vector3d* f = &MemoryMarshal.GetReference(forces))
            fixed (byte* error = why)
            {
                if (Native.palpate_query(Open, at, (UIntPtr)positions.Length, f, error,
                                         Room) != 0)
                {
                    throw new PalpateException(Text.FromNative(why));
                }
            }
        }

        /// <summary>One turn of the slow process, with BodyFlags.OwnSlowSteps alone.</summary>
        /// <returns>Elements sent.</returns>
        /// <exception cref="PalpateException">With the library's reason.</exception>
        public int SlowStep()
        {
            int sent = Native.palpate_slow_step(Open);
            if (sent < 0)
            {
                throw new PalpateException(
                    SlowFailure ?? "no slow steps of the host's: BodyFlags.OwnSlowSteps is not set");
            }
            return sent;
        }

        /// <summary>Null while the slow process is well, else what ended it.</summary>
        public string SlowFailure
        {
            get
            {
                byte[] text = new byte[Text.Room];
                fixed (byte* line = text)
                {
                    return Native.palpate_slow_failure(Open, line, Room) == 0
                        ? null
                        : Text.FromNative(text);
                }
            }
        }

        /// <summary>How the service of a scene is; of a database all zero.</summary>
        public Service Service
        {
            get
            {
                NativeService all = default(NativeService);
                all.StructSize = (UIntPtr)sizeof(NativeService);
                if (Native.palpate_service_get(Open, &all) != 0)
                {
                    throw new PalpateException("the library could not say how the service is");
                }
                byte[] detail = new byte[256];
                Marshal.Copy((IntPtr)all.Detail, detail, 0, detail.Length);
                return new Service
                {
                    State = (ServiceState)all.State,
                    Started = all.Started != 0,
                    Nodes = all.Nodes,
                    Answered = all.Answered,
                    Finished = all.Finished,
                    Softened = all.Softened,
                    Detail = Text.FromNative(detail)
                };
            }
        }

        public void Dispose()
        {
            disposed = true;
            handle.Dispose();
        }

        // A body whose tools still hold it is none to its host any more.
        private BodyHandle Open
        {
            get
            {
                if (disposed)
                {
                    throw new ObjectDisposedException("Body");
                }
                return handle;
            }
        }

        // Of a file where there are no bytes.
        private static BodyHandle Opened(string file, byte[] bytes, BodyOptions given)
        {
            Library.RequireVersion();
            byte[] why = new byte[Text.Room];
            bool keeps = bytes != null && (given.Flags & BodyFlags.Streamed) != 0;
            GCHandle kept = keeps ? GCHandle.Alloc(bytes, GCHandleType.Pinned) : default(GCHandle);
            IntPtr body;
            fixed (byte* name = Text.ToNative(file), tool = Text.ToNative(given.ToolName),
                   model = Text.ToNative(given.Model), server = Text.ToNative(given.Server),
                   output = Text.ToNative(given.Output), error = why, all = bytes)
            {
                NativeOptions options = given.Filled(tool, model, server, output);
                body = bytes == null
                    ? Native.palpate_open(name, &options, error, Room)
                    : Native.palpate_open_memory(all, (UIntPtr)bytes.Length, &options, error,
                                                 Room);
            }
            if (body != IntPtr.Zero)
            {
                return new BodyHandle(body, kept);
            }
            if (keeps)
            {
                kept.Free();
            }
            throw new PalpateException(Text.FromNative(why));
        }

        private Tool Opened(IntPtr tool, byte[] why, int hands)
        {
            if (tool == IntPtr.Zero)
            {
                throw new PalpateException(Text.FromNative(why));
            }
            return new Tool(new ToolHandle(tool, handle), hands, VertexCount);
        }

        private int Count(bool triangles)
        {
            UIntPtr vertices, corners;
            if (Native.palpate_mesh_count(Open, &vertices, &corners) != 0)
            {
                return 0;
            }
            return checked((int)(triangles ? corners : vertices));
        }
    }

    internal static class Lengths
    {
        public static void Require(string what, int length, int right, bool orNone)
        {
            if (length != right && !(orNone && length == 0))
            {
                throw new ArgumentException(what + ": " + length + " given, " + right +
                                            (orNone ? " or none" : "") + " would be right");
            }
        }
    }
}

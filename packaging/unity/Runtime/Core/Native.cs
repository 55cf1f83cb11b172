// The functions of the C interface, and the handles that keep what they give alive.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Palpate
{
    /// <summary>What the library answered, in its own words.</summary>
    public sealed class PalpateException : Exception
    {
        public PalpateException(string message) : base(message) { }
    }

    // A body ends with its last holder: its own object, or any of its tools.
    internal sealed class BodyHandle : SafeHandle
    {
        private GCHandle bytes;

        /// <param name="bytes">What the body reads until it ends; none: default.</param>
        public BodyHandle(IntPtr body, GCHandle bytes) : base(IntPtr.Zero, true)
        {
            this.bytes = bytes;
            SetHandle(body);
        }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        protected override bool ReleaseHandle()
        {
            Native.palpate_close(handle);
            if (bytes.IsAllocated)
            {
                bytes.Free();
            }
            return true;
        }
    }

    // The library frees a tool with its body, which the tool holds until then.
    internal sealed class ToolHandle : SafeHandle
    {
        private readonly BodyHandle body;

        // Throws ObjectDisposedException where the body is closed already.
        public ToolHandle(IntPtr tool, BodyHandle body) : base(IntPtr.Zero, true)
        {
            bool held = false;
            body.DangerousAddRef(ref held);
            this.body = body;
            SetHandle(tool);
        }

        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }

        protected override bool ReleaseHandle()
        {
            body.DangerousRelease();
            return true;
        }
    }

    // UTF-8 to and from the library.
    internal static class Text
    {
        public const int Room = 512;

        /// Null stays null.
        public static byte[] ToNative(string text)
        {
            if (text == null)
            {
                return null;
            }
            if (text.IndexOf('\0') >= 0)
            {
                throw new ArgumentException("a name must not hold a zero character");
            }
            return Encoding.UTF8.GetBytes(text + "\0");
        }

        public static string FromNative(byte[] text)
        {
            int end = Array.IndexOf(text, (byte)0);
            return Encoding.UTF8.GetString(text, 0, end < 0 ? text.Length : end);
        }
    }

    internal static unsafe class Native
    {
        // libpalpate.so, palpate.dll: the system adds what is before and behind.
        private const string Name = "palpate";
        private const CallingConvention C = CallingConvention.Cdecl;

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_abi_version();

        [DllImport(Name, CallingConvention = C)]
        public static extern IntPtr palpate_open(byte* file, NativeOptions* options,
                                                 byte* error, UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern IntPtr palpate_open_memory(byte* bytes, UIntPtr byteCount,
                                                        NativeOptions* options, byte* error,
                                                        UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern IntPtr palpate_tool_open(BodyHandle body, byte* error,
                                                      UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern IntPtr palpate_together_open(BodyHandle body,
                                                          byte* secondTool, byte* error,
                                                          UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern double palpate_needed_damping(BodyHandle body);

        [DllImport(Name, CallingConvention = C)]
        public static extern void palpate_hdf5_lock();

        [DllImport(Name, CallingConvention = C)]
        public static extern void palpate_hdf5_unlock();

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_service_get(BodyHandle body, NativeService* service);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_slow_step(BodyHandle body);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_slow_failure(BodyHandle body, byte* text,
                                                      UIntPtr textBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_place(BodyHandle body, Vector3d* position,
                                               Quaterniond* quatXyzw);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_mesh_count(BodyHandle body, UIntPtr* vertices,
                                                    UIntPtr* triangles);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_mesh_get(BodyHandle body, Vector3d* vertices,
                                                  int* triangles);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_query(BodyHandle body, Vector3d* positions,
                                               UIntPtr count, Vector3d* forcesOut,
                                               byte* error, UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_step(ToolHandle tool, ToolPose* poses, UIntPtr hands,
                                              double dtS, Wrench* wrenchesOut);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_force(ToolHandle tool, Vector3d* position,
                                               Quaterniond* quatXyzw, double dtS,
                                               Vector3d* forceOut);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_wrench(ToolHandle tool, Vector3d* position,
                                                Quaterniond* quatXyzw, double dtS,
                                                Vector3d* forceOut, Vector3d* torqueOut);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_together(ToolHandle tool, Vector3d* positions,
                                                  Quaterniond* quatsXyzw, double dtS,
                                                  Vector3d* forcesOut, Vector3d* torquesOut);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_delivered(ToolHandle tool, Vector3d* force,
                                                   Vector3d* torque);

        [DllImport(Name, CallingConvention = C)]
        public static extern void palpate_state_get(ToolHandle tool, ToolState* state);

        [DllImport(Name, CallingConvention = C)]
        public static extern void palpate_reset(ToolHandle tool);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_surface_save(ToolHandle tool, byte* file,
                                                      byte* error, UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_surface_load(ToolHandle tool, byte* file,
                                                      byte* error, UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern IntPtr palpate_fault_name(int status);

        [DllImport(Name, CallingConvention = C)]
        public static extern void palpate_close(IntPtr body);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_contacts_get(ToolHandle tool, Contact* contacts,
                                                      UIntPtr room, UIntPtr contactBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_displaced(ToolHandle tool, Contact* contacts,
                                                   UIntPtr count, UIntPtr contactBytes,
                                                   Vector3d* displacements, byte* error,
                                                   UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_needle_get(ToolHandle tool, NeedleState* needle,
                                                    byte* error, UIntPtr errorBytes);

        [DllImport(Name, CallingConvention = C)]
        public static extern int palpate_channels_get(ToolHandle tool, Channel* channels,
                                                      UIntPtr room, UIntPtr channelBytes,
                                                      byte* error, UIntPtr errorBytes);
    }
}

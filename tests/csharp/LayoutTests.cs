// The structs, enums and functions of the C headers, as a C program prints them.
using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using System.Reflection;
using System.Runtime.InteropServices;
using Palpate;

[Tests]
public static class LayoutTests
{
    private static readonly Assembly Files = typeof(Body).Assembly;

    private static readonly Dictionary<string, string> Structs = new Dictionary<string, string>
    {
        { "palpate_options", "NativeOptions" }, { "palpate_state", "ToolState" },
        { "palpate_service", "NativeService" }, { "palpate_pose", "ToolPose" },
        { "palpate_hand_wrench", "Wrench" }, { "palpate_contact", "Contact" },
        { "palpate_needle", "NeedleState" }, { "palpate_channel", "Channel" }
    };

    // Beginnings of C's names, the enums of C#.
    private static readonly Dictionary<string, string> Enums = new Dictionary<string, string>
    {
        { "PALPATE_ANSWER_", "Answer" }, { "PALPATE_SERVICE_", "ServiceState" },
        { "PALPATE_FAULT_", "Status" }, { "PALPATE_ERROR_", "Status" },
        { "PALPATE_FREE", "Status" }, { "PALPATE_CONTACT", "Status" }, { "PALPATE_", "BodyFlags" }
    };

    // palpate_tool_open() is palpate_tool_add() that says why not.
    private static readonly string[] NotBound = { "palpate_tool_add" };

    private static IEnumerable<string[]> Lines(string kind)
    {
        List<string[]> lines = File.ReadLines(Given.File("layout.txt"))
                                   .Select(line => line.Split(' '))
                                   .Where(words => words[0] == kind)
                                   .ToList();
        Check.True(lines.Count > 0, "no " + kind);
        return lines;
    }

    private static Type Struct(string name) { return Files.GetType("Palpate." + Structs[name], true); }

    // "work_j" and "WorkJ", "device_damping_n_s_per_m" and "DeviceDampingNSPerM".
    private static string Plain(string name) { return name.Replace("_", "").ToLowerInvariant(); }

    public static void StructsAreAsLongAsInC()
    {
        foreach (string[] line in Lines("size"))
        {
            Check.Equal(line[1] + " " + line[2], line[1] + " " + Marshal.SizeOf(Struct(line[1])));
        }
    }

    public static void MembersLieWhereTheyLieInC()
    {
        foreach (string[] line in Lines("member"))
        {
            Type type = Struct(line[1]);
            string name = line[1] == "palpate_pose" && line[2] == "quat_xyzw" ? "rotation" : line[2];
            FieldInfo field = type.GetFields(BindingFlags.Instance | BindingFlags.Public |
                                             BindingFlags.NonPublic)
                                  .FirstOrDefault(each => Plain(each.Name) == Plain(name));
            Check.True(field != null, type.Name + " has no " + line[2]);
            string where = type.Name + "." + field.Name + " ";
            Check.Equal(where + line[3], where + Marshal.OffsetOf(type, field.Name));
        }
    }

    public static void EnumsHaveTheNumbersOfC()
    {
        foreach (string[] line in Lines("enum"))
        {
            string begin = Enums.Keys.First(each => line[1].StartsWith(each));
            Type type = Files.GetType("Palpate." + Enums[begin], true);
            string name = line[1].Length == begin.Length ? line[1].Substring(8)
                                                         : line[1].Substring(begin.Length);
            object value = Enum.Parse(type, name.Replace("_", ""), true);
            Check.Equal(line[1] + " " + line[2],
                        line[1] + " " + Convert.ToInt64(value));
        }
    }

    public static void EveryFunctionIsBound()
    {
        Type native = Files.GetType("Palpate.Native", true);
        foreach (string name in Lines("function").Select(line => line[1]).Except(NotBound))
        {
            MethodInfo method = native.GetMethod(name);
            Check.True(method != null, name + " is not bound");
            DllImportAttribute import = method.GetCustomAttribute<DllImportAttribute>();
            Check.Equal("palpate", import.Value);
            Check.Equal(CallingConvention.Cdecl, import.CallingConvention);
        }
    }

    public static void TheLibraryHasTheVersion() { Library.RequireVersion(); }
}

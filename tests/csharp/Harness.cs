// Finds the tests, runs them, and says what they were given.
using System;
using System.Collections.Generic;
using System.Diagnostics;
using System.IO;
using System.Linq;
using System.Reflection;
using Palpate;

/// <summary>Every public static function without arguments of such a class is a test.</summary>
[AttributeUsage(AttributeTargets.Class)]
public sealed class TestsAttribute : Attribute
{
}

public static class Given
{
    public static string Folder;

    public static bool Windows { get { return Path.DirectorySeparatorChar == '\\'; } }

    public static string File(string name) { return Path.Combine(Folder, name); }

    public static BodyOptions OwnSlowSteps(string tool = null)
    {
        return new BodyOptions { ToolName = tool, Flags = BodyFlags.OwnSlowSteps };
    }

    /// <summary>What the C host prints.</summary>
    public static string[] Host(params string[] arguments)
    {
        ProcessStartInfo start = new ProcessStartInfo(File("host"), string.Join(" ", arguments));
        start.UseShellExecute = false;
        start.RedirectStandardOutput = true;
        using (Process host = Process.Start(start))
        {
            string text = host.StandardOutput.ReadToEnd();
            host.WaitForExit();
            Check.Equal(0, host.ExitCode);
            return text.Replace("\r", "").Split(new[] { '\n' }, StringSplitOptions.RemoveEmptyEntries);
        }
    }
}

public static class Check
{
    public static void True(bool holds, string what)
    {
        if (!holds)
        {
            throw new Exception(what);
        }
    }

    public static void Equal<T>(T right, T is_)
    {
        True(EqualityComparer<T>.Default.Equals(right, is_), is_ + ", " + right + " is right");
    }

    public static void Near(double right, double is_, double within)
    {
        True(Math.Abs(right - is_) <= within, is_ + ", " + right + " +- " + within + " is right");
    }

    public static void Near(Vector3d right, Vector3d is_, double within)
    {
        True((right - is_).Length <= within, is_ + ", " + right + " +- " + within + " is right");
    }

    /// <summary>Throws that, and says each of these words.</summary>
    public static void Throws<T>(Action action, params string[] words) where T : Exception
    {
        try
        {
            action();
        }
        catch (T thrown)
        {
            foreach (string word in words)
            {
                True(thrown.Message.Contains(word), "\"" + thrown.Message + "\" lacks " + word);
            }
            return;
        }
        throw new Exception("no " + typeof(T).Name);
    }
}

public static class Harness
{
    public static int Main(string[] arguments)
    {
        Given.Folder = arguments[0];
        if (arguments[1] == "speed")
        {
            return StepSpeed.Print();
        }
        int passed = 0, failed = 0;
        var tests = from type in Assembly.GetExecutingAssembly().GetTypes()
                    where type.IsDefined(typeof(TestsAttribute), false)
                    from test in type.GetMethods(BindingFlags.Public | BindingFlags.Static)
                    where test.GetParameters().Length == 0
                    orderby type.Name
                    select test;
        foreach (MethodInfo test in tests)
        {
            string name = test.DeclaringType.Name + "." + test.Name;
            try
            {
                test.Invoke(null, null);
                ++passed;
            }
            catch (TargetInvocationException thrown)
            {
                Console.WriteLine("FAILED " + name + ": " + thrown.InnerException);
                ++failed;
            }
        }
        Console.WriteLine(passed + " passed, " + failed + " failed");
        return failed == 0 && passed > 0 ? 0 : 1;
    }
}

// The components, in a stand-in for Unity's engine: what they do, not how it looks.
using System;
using System.Linq;
using System.Threading;
using Palpate;
using Palpate.Unity;
using UnityEngine;

[Tests]
public static class SceneTests
{
    private sealed class Still : IHapticDevice
    {
        public ToolPose Pose;
        public Wrench Last;

        public ToolPose Read() { return Pose; }

        public void Write(Wrench wrench) { Last = wrench; }
    }

    private static PalpateBody Stand(string file, string tool, Vector3 at)
    {
        Debug.Errors.Clear();
        Application.streamingAssetsPath = Given.Folder;
        GameObject stood = new GameObject("organ");
        stood.SetActive(false);
        stood.AddComponent<MeshCollider>();
        stood.transform.position = at;
        PalpateBody body = stood.AddComponent<PalpateBody>();
        body.file = file;
        body.toolName = tool;
        stood.SetActive(true);
        return body;
    }

    private static PalpateTool Touch(PalpateBody body, Vector3 at, IHapticDevice device = null)
    {
        GameObject held = new GameObject("finger");
        held.SetActive(false);
        held.transform.position = at;
        PalpateTool tool = held.AddComponent<PalpateTool>();
        tool.body = body;
        tool.Device = device;
        held.SetActive(true);
        return tool;
    }

    // Frames of 20 ms until something holds.
    private static void Frames(Func<bool> holds, string what, params GameObject[] objects)
    {
        for (int i = 0; i < 200 && !holds(); ++i)
        {
            Thread.Sleep(20);
            Array.ForEach(objects, each => each.Send("Update"));
            Array.ForEach(objects, each => each.Send("LateUpdate"));
        }
        Check.True(holds(), what + "; " + string.Join(", ", Debug.Errors));
    }

    public static void ABodyIsDrawnUpwardsWithItsFrontOutside()
    {
        PalpateBody body = Stand("plate.h5", "", new Vector3(0, 2, 0));
        Mesh mesh = body.GetComponent<MeshFilter>().sharedMesh;
        Check.Equal(121, mesh.vertices.Length);
        Check.True(mesh.vertices.All(v => v.y == 0.0f), "the plate lies in x and z");
        MeshCollider surface = body.GetComponent<MeshCollider>();
        RaycastHit hit;
        Check.True(surface.Raycast(new Ray(new Vector3(0.01f, 3, 0.02f), new Vector3(0, -1, 0)),
                                   out hit, 100.0f), "no front face from above");
        Check.Near(2.0, hit.point.y, 1e-6);
        Check.True(!surface.Raycast(new Ray(new Vector3(0.01f, 0, 0.02f), new Vector3(0, 1, 0)),
                                    out hit, 100.0f), "a front face from below");
        body.gameObject.SetActive(false);
        Check.Equal(null, body.Body);
    }

    public static void ADatabaseMayBeAnAsset()
    {
        PalpateBody body = Stand("none.h5", "", Vector3.zero);
        body.gameObject.SetActive(false);
        body.database = new TextAsset { bytes = System.IO.File.ReadAllBytes(Given.File("plate.palpate")) };
        body.gameObject.SetActive(true);
        Check.Equal(121, body.Body.VertexCount);
        body.gameObject.SetActive(false);
    }

    public static void ATransformPressesWhereTheBodyStands()
    {
        PalpateBody body = Stand("plate.h5", "", new Vector3(1, 2, 3));
        PalpateTool tool = Touch(body, new Vector3(1.003f, 2.02f, 3.002f));
        Check.Near(0.005, tool.Radius, 1e-9);
        Frames(() => tool.Status == Status.Free && tool.Frame.State.Ticks > 20, "no ticks",
               tool.gameObject);
        tool.transform.position = new Vector3(1.003f, 2.003f, 3.002f);  // 2 mm deep
        Frames(() => tool.Force.y > 0.0795f, "no force", tool.gameObject, body.gameObject);
        Check.Near(0.08, tool.Force.y, 5e-4);
        Check.True(Math.Abs(tool.Force.x) < 0.03f && Math.Abs(tool.Force.z) < 0.03f, "aside");
        body.transform.position = new Vector3(1, 1, 3);
        body.Place();
        Frames(() => tool.Status == Status.Free, "pressed yet", tool.gameObject);
        body.gameObject.SetActive(false);
        Check.True(!tool.enabled, "a tool without a body");
        Check.Equal("", string.Join(", ", Debug.Errors));
    }

    public static void ADeviceLeadsAndFeelsInTheEnginesAxes()
    {
        PalpateBody body = Stand("pads.h5", "pads", new Vector3(0, 1, 0));
        Still device = new Still
        {
            Pose = new ToolPose(new Vector3d(0.001, 1.01, 0.002),
                                new Quaterniond(0, 0, Math.Sin(0.02), Math.Cos(0.02)))
        };
        PalpateTool tool = Touch(body, Vector3.zero, device);
        Frames(() => tool.Frame.State.Ticks > 50, "no ticks", tool.gameObject);
        device.Pose.Position.Y = 1.003;
        Frames(() => tool.Frame.State.Ticks > 500 && device.Last.Force.Y > 0.1, "no force",
               tool.gameObject, body.gameObject);
        Check.Near(1.003, tool.transform.position.y, 1e-6);
        Check.Near(Math.Sin(0.02), tool.transform.rotation.z, 1e-6);
        // Turned about +z by the engine's formulas, +x goes up: -x is pressed more, which turns
        // it back, about -z.
        Check.True(device.Last.Torque.Z < -1e-4, "torque " + device.Last.Torque);
        Check.Near(device.Last.Torque.Z, tool.Torque.z, 1e-3);
        tool.gameObject.SetActive(false);
        Check.Equal(default(Wrench), device.Last);
        body.gameObject.SetActive(false);
    }

    public static void TheSurfaceDeformsUnderTheToolAndComesBack()
    {
        PalpateBody body = Stand("pads.h5", "ball", new Vector3(0, 1, 0));
        // Half a turn about x: the plate's outside is below.
        body.transform.rotation = new Quaternion(1, 0, 0, 0);
        body.Place();
        PalpateTool tool = Touch(body, new Vector3(0.001f, 0.98f, 0.002f));
        Mesh mesh = body.GetComponent<MeshFilter>().sharedMesh;
        Vector3[] rest = mesh.vertices;
        tool.transform.position = new Vector3(0.001f, 0.997f, 0.002f);  // 2 mm deep, from below
        Frames(() => tool.Force.y < -0.079f && mesh.vertices[7].y < rest[7].y, "no dent",
               tool.gameObject, body.gameObject);
        // In the body's own frame the outside is above; 4 mm sink a vertex by 1 mm.
        Check.Near(rest[7].y - 0.0005, mesh.vertices[7].y, 2e-5);
        Check.Near(rest[7].x, mesh.vertices[7].x, 1e-6);
        tool.transform.position = new Vector3(0.001f, 0.98f, 0.002f);
        Frames(() => mesh.vertices[7].y == rest[7].y, "a dent stays", tool.gameObject,
               body.gameObject);
        body.gameObject.SetActive(false);
    }

    public static void WhatIsWrongIsLoggedInTheLibrarysWords()
    {
        PalpateBody body = Stand("none.h5", "", Vector3.zero);
        Check.Equal(null, body.Body);
        Check.True(Debug.Errors.Single().Contains("organ: ") &&
                   Debug.Errors.Single().Contains(Given.File("none.h5")), Debug.Errors[0]);
        PalpateTool tool = Touch(body, Vector3.zero);
        Check.True(Debug.Errors.Last().Contains("finger: its body"), Debug.Errors.Last());
        tool.gameObject.Send("Update");
        body = Stand("plate.h5", "hammer", Vector3.zero);
        Check.True(Debug.Errors.Single().Contains("hammer"), Debug.Errors[0]);
        body = Stand("plate.h5", "", Vector3.zero);
        body.gameObject.SetActive(false);
        body.transform.localScale = 2.0f * Vector3.one;
        body.gameObject.SetActive(true);
        Check.True(Debug.Errors.Single().Contains("must be 1"), Debug.Errors[0]);
    }

    public static void TheSamplePressesWithTheMouse()
    {
        Debug.Errors.Clear();
        Application.streamingAssetsPath = Given.Folder;
        GameObject empty = new GameObject("press with mouse");
        PressWithMouse sample = empty.AddComponent<PressWithMouse>();
        sample.file = "plate.h5";
        sample.depthMax = 0.002f;
        empty.Send("Start");
        Check.True(sample.Tool.body.GetComponent<MeshRenderer>().sharedMaterial != null, "magenta");
        Check.Near(0.0, Camera.main.transform.LookedAt.magnitude, 1e-6);
        Check.True(Camera.main.transform.position.y > 0.08f, "not from above");
        Camera.main.View = new Ray(new Vector3(0.003f, 0.5f, 0.002f), new Vector3(0, -1, 0));
        PalpateTool tool = sample.Tool;
        Input.Pressed = true;
        Frames(() => tool.Force.y > 0.0795f, "no force", empty, tool.gameObject,
               tool.body.gameObject);
        Check.Near(0.08, tool.Force.y, 5e-4);
        Input.Pressed = false;
        Frames(() => tool.Status == Status.Free, "pressed yet", empty, tool.gameObject);
        tool.body.gameObject.SetActive(false);
        Check.Equal("", string.Join(", ", Debug.Errors));
    }

    public static void TheExamplesOfThePageRun()
    {
        Check.Near(0.08, Press.Force(Given.File("plate.h5")), 1e-6);
        PalpateBody body = Stand("plate.h5", "", Vector3.zero);
        GameObject held = new GameObject("finger");
        held.SetActive(false);
        PalpateTool tool = held.AddComponent<PalpateTool>();
        Spring spring = held.AddComponent<Spring>();
        held.AddComponent<Gauge>().tool = tool;
        tool.body = body;
        spring.Send("Awake");
        held.SetActive(true);
        Frames(() => Math.Abs(held.transform.position.y - 0.1f) < 1e-6f, "not led", held);
        body.gameObject.SetActive(false);
        Check.Equal("", string.Join(", ", Debug.Errors));
    }
}

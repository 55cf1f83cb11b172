using System;
using System.Collections.Generic;
using System.IO;
using UnityEngine;
using UnityEngine.Rendering;

namespace Palpate.Unity
{
    /// <summary>
    /// A body of a response database, drawn where its transform stands, and deformed under the
    /// tools where the database holds displacement fields. Its scale must be 1. Its tools are
    /// disabled with it.
    /// </summary>
    [DefaultExecutionOrder(-100)]
    [RequireComponent(typeof(MeshFilter), typeof(MeshRenderer))]
    [AddComponentMenu("palpate/Body")]
    public sealed class PalpateBody : MonoBehaviour
    {
        [Tooltip("Response database: a path, of StreamingAssets if it is relative.")]
        public string file = "body.palpate";
        [Tooltip("The same as an asset, a file *.bytes; if it is set, the path is not used.")]
        public TextAsset database;
        [Tooltip("The database's tool; empty: its only one.")]
        public string toolName = "";
        [Tooltip("Local model; empty: potential.")]
        public string model = "";
        [Tooltip("[m] length of one unit of this scene.")]
        public double metresPerUnit = 1.0;
        [Tooltip("[N s/m] the device's own damping; 0: unknown, and nobody checks the bound.")]
        public double deviceDampingNSPerM;
        [Tooltip("Softens a body that is too stiff for the device, instead of refusing it.")]
        public bool limitStiffness;
        [Tooltip("Draws the surface as the tools deform it.")]
        public bool drawsDeformed = true;

        private readonly List<PalpateTool> tools = new List<PalpateTool>();
        private Body body;
        private Mesh mesh;
        private Vector3d[] moved = new Vector3d[0];
        private Vector3[] rest = new Vector3[0];
        private Vector3[] drawn = new Vector3[0];
        private bool deformed;

        /// <summary>Null where it could not be opened: the console says why.</summary>
        public Body Body { get { return body; } }

        /// <summary>Puts the body where its transform is now. The tools' threads pause.</summary>
        public void Place()
        {
            foreach (PalpateTool tool in tools)
            {
                tool.Pause();
            }
            body.Place(Engine.ToLibrary(transform.position),
                       Engine.ToLibrary(transform.rotation));
            foreach (PalpateTool tool in tools)
            {
                tool.Continue();
            }
        }

        internal void Add(PalpateTool tool) { tools.Add(tool); }

        internal void Remove(PalpateTool tool) { tools.Remove(tool); }

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
            foreach (PalpateTool tool in tools.ToArray())
            {
                tool.enabled = false;
            }
            if (body != null)
            {
                body.Dispose();
                body = null;
            }
        }

        private void OnDestroy()
        {
            if (mesh != null)
            {
                Destroy(mesh);
            }
        }

        private void LateUpdate()
        {
            if (body == null || !drawsDeformed)
            {
                return;
            }
            bool now = false;
            Quaternion back = Quaternion.Inverse(transform.rotation);
            foreach (PalpateTool tool in tools)
            {
                now |= Deform(tool, back, !now);
            }
            if (now || deformed)
            {
                mesh.vertices = now ? drawn : rest;
                mesh.RecalculateNormals();
            }
            deformed = now;
        }

        private void Open()
        {
            if ((transform.lossyScale - Vector3.one).magnitude > 1e-5f)
            {
                throw new PalpateException("its scale is " + transform.lossyScale +
                                           ", must be 1: metresPerUnit is the scene's unit");
            }
            BodyOptions options = new BodyOptions
            {
                ToolName = toolName.Length == 0 ? null : toolName,
                Model = model.Length == 0 ? null : model,
                MetresPerUnit = metresPerUnit,
                DeviceDampingNSPerM = deviceDampingNSPerM,
                Flags = limitStiffness ? BodyFlags.LimitStiffness : BodyFlags.None
            };
            body = database == null
                ? new Body(Path.Combine(Application.streamingAssetsPath, file), options)
                : new Body(database.bytes, options);
            Draw();
            Place();
        }

        // The surface in the body's own frame, which the transform turns: before Place().
        private void Draw()
        {
            moved = new Vector3d[body.VertexCount];
            int[] corners = new int[3 * body.TriangleCount];
            body.Mesh(moved, corners);
            Axes.Triangles(corners);
            rest = Array.ConvertAll(moved, Engine.ToEngine);
            drawn = (Vector3[])rest.Clone();
            if (mesh == null)
            {
                mesh = new Mesh();
            }
            mesh.Clear();
            mesh.name = name;
            mesh.indexFormat = IndexFormat.UInt32;
            mesh.vertices = rest;
            mesh.triangles = corners;
            mesh.RecalculateNormals();
            mesh.RecalculateBounds();
            GetComponent<MeshFilter>().sharedMesh = mesh;
            MeshCollider collider = GetComponent<MeshCollider>();
            if (collider != null)
            {
                collider.sharedMesh = mesh;
            }
        }

        // True where a tool's contacts have displacement fields. They are the world's.
        private bool Deform(PalpateTool tool, Quaternion back, bool first)
        {
            if (tool.Displaced(moved) == 0)
            {
                return false;
            }
            for (int i = 0; i < drawn.Length; ++i)
            {
                drawn[i] = (first ? rest[i] : drawn[i]) + back * Engine.ToEngine(moved[i]);
            }
            return true;
        }
    }
}

// Of UnityEngine the members that packaging/unity uses, as its manual says that they behave:
// objects, their components and messages. Nothing here is Unity's code.
using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    public class Object
    {
        public string name = "";
        public bool Destroyed { get; private set; }

        public static void Destroy(Object gone) { gone.Destroyed = true; }
    }

    public class Component : Object
    {
        public GameObject gameObject { get; internal set; }
        public Transform transform { get { return gameObject.transform; } }

        public T GetComponent<T>() where T : Component { return gameObject.GetComponent<T>(); }

        public void Send(string message)
        {
            MethodInfo method = GetType().GetMethod(
                message, BindingFlags.Instance | BindingFlags.NonPublic | BindingFlags.Public);
            if (method != null)
            {
                method.Invoke(this, null);
            }
        }
    }

    public class Behaviour : Component
    {
        private bool wanted = true;
        private bool on;

        public bool enabled
        {
            get { return wanted; }
            set
            {
                wanted = value;
                Refresh();
            }
        }

        internal void Refresh()
        {
            bool now = wanted && gameObject.activeSelf;
            if (now != on)
            {
                on = now;
                Send(on ? "OnEnable" : "OnDisable");
            }
        }
    }

    public class MonoBehaviour : Behaviour
    {
    }

    public class Transform : Component
    {
        public Vector3 position;
        public Quaternion rotation = Quaternion.identity;
        public Vector3 localScale = Vector3.one;
        public Vector3 lossyScale { get { return localScale; } }
        public Vector3 LookedAt;

        public void LookAt(Vector3 there) { LookedAt = there; }
    }

    public enum PrimitiveType
    {
        Sphere
    }

    public sealed class GameObject : Object
    {
        private readonly List<Component> components = new List<Component>();

        public GameObject(string name)
        {
            this.name = name;
            transform = new Transform { gameObject = this };
            activeSelf = true;
        }

        public Transform transform { get; private set; }
        public bool activeSelf { get; private set; }

        public static GameObject CreatePrimitive(PrimitiveType type)
        {
            GameObject made = new GameObject(type.ToString());
            made.AddComponent<MeshRenderer>().sharedMaterial = new Material();
            return made;
        }

        public T AddComponent<T>() where T : Component { return (T)Add(typeof(T)); }

        public T GetComponent<T>() where T : Component
        {
            return (T)components.Find(each => each is T);
        }

        public void SetActive(bool active)
        {
            activeSelf = active;
            foreach (Component each in components.ToArray())
            {
                if (each is Behaviour)
                {
                    ((Behaviour)each).Refresh();
                }
            }
        }

        public void Send(string message)
        {
            foreach (Component each in components.ToArray())
            {
                if (!(each is Behaviour) || ((Behaviour)each).enabled)
                {
                    each.Send(message);
                }
            }
        }

        private Component Add(Type type)
        {
            foreach (RequireComponent needed in type.GetCustomAttributes(
                         typeof(RequireComponent), true))
            {
                Array.ForEach(needed.Types, other => Add(other));
            }
            Component made = (Component)Activator.CreateInstance(type);
            made.gameObject = this;
            made.name = name;
            components.Add(made);
            if (made is Behaviour)
            {
                ((Behaviour)made).Refresh();
            }
            return made;
        }
    }

    public sealed class Mesh : Object
    {
        public Vector3[] vertices = new Vector3[0];
        public int[] triangles = new int[0];
        public Rendering.IndexFormat indexFormat;

        public void Clear() { }
        public void RecalculateNormals() { }
        public void RecalculateBounds() { }
    }

    public class MeshFilter : Component
    {
        public Mesh sharedMesh;
    }

    public sealed class Material : Object
    {
    }

    public class MeshRenderer : Component
    {
        public Material sharedMaterial;

        public Bounds bounds
        {
            get
            {
                Vector3 low = float.MaxValue * Vector3.one, high = -1.0f * low;
                foreach (Vector3 vertex in GetComponent<MeshFilter>().sharedMesh.vertices)
                {
                    Vector3 at = transform.position + transform.rotation * vertex;
                    low = Vector3.Min(low, at);
                    high = Vector3.Max(high, at);
                }
                return new Bounds
                {
                    center = 0.5f * (low + high),
                    extents = 0.5f * (high - low)
                };
            }
        }
    }

    public class Collider : Component
    {
        public virtual bool Raycast(Ray ray, out RaycastHit hit, float most)
        {
            hit = default(RaycastHit);
            return false;
        }
    }

    public sealed class MeshCollider : Collider
    {
        public Mesh sharedMesh;

        // Of front faces alone: those whose corners lie clockwise as the ray sees them.
        public override bool Raycast(Ray ray, out RaycastHit hit, float most)
        {
            hit = default(RaycastHit);
            float nearest = most;
            for (int i = 0; i + 2 < sharedMesh.triangles.Length; i += 3)
            {
                Vector3 a = World(i), ab = World(i + 1) - a, ac = World(i + 2) - a;
                Vector3 normal = Vector3.Cross(ab, ac);  // clockwise in left-handed axes
                float against = -Vector3.Dot(normal, ray.direction);
                if (against <= 0.0f)
                {
                    continue;
                }
                Vector3 from = ray.origin - a, across = Vector3.Cross(from, ray.direction);
                float t = Vector3.Dot(normal, from) / against;
                float u = -Vector3.Dot(ac, across) / against, v = Vector3.Dot(ab, across) / against;
                if (t >= 0.0f && t < nearest && u >= 0.0f && v >= 0.0f && u + v <= 1.0f)
                {
                    nearest = t;
                    hit.point = ray.origin + t * ray.direction;
                }
            }
            return nearest < most;
        }

        private Vector3 World(int corner)
        {
            return transform.position +
                   transform.rotation * sharedMesh.vertices[sharedMesh.triangles[corner]];
        }
    }

    public sealed class Camera : Behaviour
    {
        public static Camera main = new GameObject("camera").AddComponent<Camera>();
        public float nearClipPlane = 0.3f;
        public Ray View;

        public Ray ScreenPointToRay(Vector3 pixel) { return View; }
    }

    public static class Input
    {
        public static Vector3 mousePosition;
        public static bool Pressed;

        public static bool GetMouseButton(int button) { return button == 0 && Pressed; }
    }

    public static class Time
    {
        public static float deltaTime = 0.02f;
    }

    public static class Application
    {
        public static string streamingAssetsPath = "";
    }

    public static class Debug
    {
        public static readonly List<string> Errors = new List<string>();

        public static void LogError(object message, Object about)
        {
            Errors.Add(message.ToString());
        }

        public static void DrawRay(Vector3 from, Vector3 along, Color color) { }
    }

    public sealed class TextAsset : Object
    {
        public byte[] bytes;
    }

    [AttributeUsage(AttributeTargets.Field)]
    public sealed class TooltipAttribute : Attribute
    {
        public TooltipAttribute(string text) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class AddComponentMenu : Attribute
    {
        public AddComponentMenu(string name) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class DefaultExecutionOrder : Attribute
    {
        public DefaultExecutionOrder(int order) { }
    }

    [AttributeUsage(AttributeTargets.Class)]
    public sealed class RequireComponent : Attribute
    {
        public RequireComponent(Type first, Type second) { Types = new[] { first, second }; }

        public Type[] Types { get; private set; }
    }
}

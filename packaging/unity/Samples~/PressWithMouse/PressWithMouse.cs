using Palpate.Unity;
using UnityEngine;

/// <summary>
/// Presses a body with the mouse: put this on an empty object, name the database, and play.
/// The tool floats over the place under the mouse. The left button presses it down along the
/// view, and the force is drawn. It reads the mouse by the old input manager.
/// </summary>
public sealed class PressWithMouse : MonoBehaviour
{
    public string file = "body.palpate";
    public float depthMax = 0.005f;         // [scene's length]
    public float speed = 0.01f;             // [scene's length / s] of a press
    public float lengthPerNewton = 0.05f;   // [scene's length / N] of the drawn force

    private Collider surface;
    private float depth;

    public PalpateTool Tool { get; private set; }

    private void Start()
    {
        GameObject pressed = new GameObject("palpate body");
        pressed.SetActive(false);  // opened when all is set
        surface = pressed.AddComponent<MeshCollider>();
        PalpateBody body = pressed.AddComponent<PalpateBody>();
        body.file = file;
        GameObject sphere = GameObject.CreatePrimitive(PrimitiveType.Sphere);
        MeshRenderer drawn = pressed.GetComponent<MeshRenderer>();
        drawn.sharedMaterial = sphere.GetComponent<MeshRenderer>().sharedMaterial;
        pressed.SetActive(true);
        LookAt(drawn.bounds);
        sphere.SetActive(false);
        sphere.transform.position = new Vector3(0.0f, 1.0f, 0.0f);
        Tool = sphere.AddComponent<PalpateTool>();
        Tool.body = body;
        sphere.SetActive(true);
        sphere.transform.localScale = 2.0f * Tool.Radius * Vector3.one;
    }

    private static void LookAt(Bounds bounds)
    {
        Camera eye = Camera.main;
        eye.nearClipPlane = 0.01f * bounds.extents.magnitude;
        eye.transform.position =
            bounds.center + 2.5f * bounds.extents.magnitude * new Vector3(0.0f, 0.6f, -0.8f);
        eye.transform.LookAt(bounds.center);
    }

    private void Update()
    {
        Ray view = Camera.main.ScreenPointToRay(Input.mousePosition);
        RaycastHit hit;
        if (surface.Raycast(view, out hit, 100.0f))
        {
            float wanted = Input.GetMouseButton(0) ? depthMax : -0.5f * Tool.Radius;
            depth = Mathf.MoveTowards(depth, wanted, speed * Time.deltaTime);
            Tool.transform.position = hit.point - (Tool.Radius - depth) * view.direction;
        }
        Debug.DrawRay(Tool.transform.position, lengthPerNewton * Tool.Force, Color.red);
    }
}

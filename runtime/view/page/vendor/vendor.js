// What the page uses of others, nothing else.
export {
  AmbientLight, BufferAttribute, BufferGeometry, Color, CylinderGeometry, ConeGeometry,
  DataTexture, DirectionalLight, DoubleSide, FloatType, Group, HemisphereLight, Line,
  LineBasicMaterial, LineDashedMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshPhysicalMaterial,
  MeshStandardMaterial, OrthographicCamera, PerspectiveCamera, Quaternion, Raycaster,
  RGBAFormat, Scene, SphereGeometry, SRGBColorSpace, LinearFilter, ClampToEdgeWrapping, Vector2,
  Vector3, WebGLRenderer, RingGeometry, Matrix4, Box3, GridHelper, PointsMaterial, Points,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
export { default as uPlot } from "uplot";

// The body, the tool and the force in three dimensions.
import * as three from "/vendor.min.js";
import { ContactTools } from "/contact_tools.js";
import { colourRamp } from "/figures.js";
import { LateralSpring } from "/lateral_spring.js";
import { NeedleTool } from "/needle_tool.js";
import { css, lay, rod } from "/shapes.js";
import { toolGeometries } from "/tool_shape.js";
import { Yielding } from "/yielding.js";

// Vertex colours by stiffness; grey where there is no response, half grey where it is a
// preliminary one.
function vertexColours(body) {
  const { low_n_per_m: low, high_n_per_m: high, colours } = body.text.map;
  const ramp = colourRamp(colours);
  const values = new Float32Array(3 * body.stiffness.length);
  const none = new three.Color("#6b7680");
  body.stiffness.forEach((stiffness, i) => {
    const c = none.clone();
    if (Number.isFinite(stiffness)) {
      c.setRGB(...ramp((stiffness - low) / (high - low)).map((v) => v / 255), three.SRGBColorSpace);
      c.lerp(none, body.quality?.[i] === 1 ? 0.5 : 0);
    }
    c.toArray(values, 3 * i);
  });
  return values;
}

function bodyGeometry(body, position, normal) {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(position, 3));
  geometry.setAttribute("normal", new three.BufferAttribute(normal, 3));
  geometry.setAttribute("color", new three.BufferAttribute(vertexColours(body), 3));
  geometry.setIndex(new three.BufferAttribute(body.triangle, 1));
  geometry.computeBoundingSphere();
  return geometry;
}

// Without a graphics card smooth edges and every pixel cost more than they give.
const kFovDegrees = 32;

function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

export class BodyView {
  // Throws where there is no WebGL. @param ask as Yielding's.
  constructor(canvas, body, ask) {
    this.canvas = canvas;
    this.body = body;
    this.software = drawsInSoftware();
    this.renderer = new three.WebGLRenderer({ canvas, antialias: !this.software, alpha: true });
    this.renderer.setPixelRatio(this.software ? 0.75 : Math.min(devicePixelRatio, 2));
    this.scene = new three.Scene();
    this.addBody(ask);
    this.addTool();
    this.addLights();
    this.addCameras();
    this.raycaster = new three.Raycaster();
    this.presses = 0;  // pictures of the yielding body
  }

  addBody(ask) {
    // Where the pointer meets the body counts at rest.
    const geometry = bodyGeometry(this.body, this.body.position, this.body.normal);
    this.rest = new three.Mesh(geometry);
    this.size = geometry.boundingSphere.radius;
    this.centre = geometry.boundingSphere.center.clone();
    this.metresPerNewton = (0.6 * this.size) / this.body.text.force_max_n;
    const { hands } = this.body.text;  // several contacts, or two hands
    if (hands) {
      this.metresPerNewton /= Math.sqrt(Math.max(...hands.map(({ spheres }) => spheres.length)));
    }
    this.yielding = new Yielding(this.body, 0.9 * this.size, ask);
    const pressed = bodyGeometry(this.body, this.yielding.position, this.yielding.normal);
    this.surface = new three.Mesh(pressed, new three.MeshStandardMaterial({
      vertexColors: true, roughness: 0.55, metalness: 0.0, side: three.DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
    this.surface.frustumCulled = false;
    if (this.body.text.puncture) {  // its channels are seen
      Object.assign(this.surface.material, { transparent: true, opacity: 0.72, depthWrite: false, forceSinglePass: false });
    }
    this.wire = new three.Mesh(pressed, new three.MeshStandardMaterial({
      color: "#0b1014", wireframe: true, transparent: true, opacity: 0.35 }));
    this.wire.frustumCulled = false;
    this.wire.visible = false;
    this.normals = this.normalLines();
    this.normals.visible = false;
    this.scene.add(this.surface, this.wire, this.normals);
    const box = geometry.boundingBox ?? (geometry.computeBoundingBox(), geometry.boundingBox);
    const grid = new three.GridHelper(8 * this.size, 40, "#5a6a74", "#5a6a74");
    grid.material.transparent = true;
    grid.material.opacity = 0.16;
    grid.rotation.x = Math.PI / 2;
    grid.position.set(this.centre.x, this.centre.y, box.min.z - 0.002 * this.size);
    this.scene.add(grid);
  }

  normalLines() {
    const { position, normal } = this.body;
    const ends = new Float32Array(2 * position.length);
    for (let i = 0; i < position.length / 3; ++i) {
      for (let k = 0; k < 3; ++k) {
        ends[6 * i + k] = position[3 * i + k];
        ends[6 * i + 3 + k] = position[3 * i + k] + 0.06 * this.size * normal[3 * i + k];
      }
    }
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(ends, 3));
    return new three.LineSegments(geometry, new three.LineBasicMaterial({ color: "#8fa1ad" }));
  }

  addTool() {
    const { shape, handle_m: handle } = this.body.text.tool;
    const thin = Math.min(0.012 * this.size, 0.25 * shape.half_width_m);
    const metal = new three.MeshStandardMaterial({ color: "#dfe6ea", roughness: 0.25, metalness: 0.1,
                                                   transparent: true, opacity: 0.62 });
    this.tool = new three.Group();
    this.needle = this.body.text.puncture
      ? new NeedleTool(this.scene, this.body.text, this.size) : null;
    this.tool.add(...(this.needle?.meshes() ?? toolGeometries(shape).map((geometry) => new three.Mesh(geometry, metal))));
    if (handle > shape.top_m && !this.needle) {
      const shaft = rod(0.28 * shape.half_width_m, metal);
      lay(shaft, new three.Vector3(0, 0, shape.top_m), new three.Vector3(0, 0, handle));
      this.tool.add(shaft);
    }
    // What lies inside the tool or the body is drawn over them.
    const above = (colour) => new three.MeshBasicMaterial({ color: colour, depthTest: false, transparent: true });
    this.hand = new three.Mesh(new three.SphereGeometry(1.6 * thin, 24, 16), above(css("hand")));
    this.band = rod(0.4 * thin, above(css("hand")));
    this.arrow = rod(0.75 * thin, above(css("force")));
    this.head = new three.Mesh(new three.ConeGeometry(2.1 * thin, 5 * thin, 24).translate(0, 2.5 * thin, 0), above(css("force")));
    this.marker = new three.Mesh(new three.SphereGeometry(1.3 * thin, 20, 14), above(css("depth")));
    this.cursor = new three.Mesh(new three.RingGeometry(2.2 * thin, 3 * thin, 32), above(css("hand")));
    this.pick = rod(0.4 * thin, above(css("depth")));
    for (const [order, mesh] of [this.cursor, this.marker, this.pick, this.band, this.hand, this.arrow, this.head].entries()) {
      mesh.renderOrder = 10 + order;
      mesh.visible = false;
    }
    this.scene.add(this.tool, this.hand, this.band, this.arrow, this.head, this.marker, this.pick, this.cursor);
    if (this.body.text.rubs) {
      this.spring = new LateralSpring(this.scene, thin);
    }
    if (this.body.text.hands) {
      this.contacts = new ContactTools(this.scene, this.body.text.hands, this.size, handle, this.metresPerNewton);
      this.tool.visible = false;
    }
  }

  addLights() {
    this.scene.add(new three.HemisphereLight("#ffffff", "#8c98a2", 1.2));
    this.lamp = new three.DirectionalLight("#fff6e8", 2.4);
    this.scene.add(this.lamp, this.lamp.target);
  }

  addCameras() {
    const near = 0.02 * this.size;
    this.perspective = new three.PerspectiveCamera(kFovDegrees, 1, near, 40 * this.size);
    this.orthographic = new three.OrthographicCamera(-1, 1, 1, -1, near, 40 * this.size);
    this.camera = this.perspective;
    if (this.needle) {  // stands out far
      this.centre.z += 0.18 * this.size;
    }
    for (const camera of [this.perspective, this.orthographic]) {
      camera.up.set(0, 0, 1);
      camera.position.copy(this.centre).add(new three.Vector3(0.9, -3.0, 1.75).multiplyScalar(1.08 * this.size));
    }
    this.useCamera(this.perspective);
  }

  useCamera(camera) {
    const target = this.orbit ? this.orbit.target.clone() : this.centre.clone();
    const from = this.camera.position.clone();
    this.orbit?.dispose();
    this.camera = camera;
    camera.position.copy(from);
    this.orbit = new three.OrbitControls(camera, this.canvas);
    this.orbit.target.copy(target);
    this.orbit.enableDamping = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.orbit.dampingFactor = 0.12;
    this.orbit.minDistance = 0.3 * this.size;
    this.orbit.maxDistance = 12 * this.size;
    this.orbit.update();
  }

  toggleCamera() {
    this.useCamera(this.camera === this.perspective ? this.orthographic : this.perspective);
  }

  focusTool() {
    this.orbit.target.copy(this.contacts ? this.contacts.hands[0].group.position : this.tool.position);
  }

  vector(list) { return new three.Vector3().fromArray(list); }

  // Right and up of the screen in the world.
  screenAxes() {
    const e = this.camera.matrixWorld.elements;
    return [[e[0], e[1], e[2]], [e[4], e[5], e[6]]];
  }

  // Height of the view [m] at the orbit's target.
  viewHeight() {
    const distance = this.camera.position.distanceTo(this.orbit.target);
    return 2 * distance * Math.tan((this.perspective.fov * Math.PI) / 360);
  }

  // Where the pointer meets the body at rest: { point, normal, node } or null.
  hit(event) {
    const box = this.canvas.getBoundingClientRect();
    const at = new three.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    this.raycaster.setFromCamera(at, this.camera);
    const [hit] = this.raycaster.intersectObject(this.rest, false);
    if (!hit) {
      return null;
    }
    const corners = [hit.face.a, hit.face.b, hit.face.c];
    const corner = (i) => new three.Vector3().fromArray(this.body.position, 3 * i);
    corners.sort((i, j) => corner(i).distanceTo(hit.point) - corner(j).distanceTo(hit.point));
    return { point: hit.point, normal: hit.normal ?? hit.face.normal, node: corners[0] };
  }

  // Which hand's tool the pointer is over, 0 or 1; -1: none.
  overTool(event) {
    const box = this.canvas.getBoundingClientRect();
    const at = new three.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    this.raycaster.setFromCamera(at, this.camera);
    if (this.contacts) {
      return this.contacts.over(this.raycaster);
    }
    return this.raycaster.intersectObject(this.tool, true).length > 0 ? 0 : -1;
  }

  showPick(curve) {
    const at = new three.Vector3().fromArray(curve.position_m);
    this.marker.position.copy(at);
    this.marker.visible = true;
    lay(this.pick, at, at.clone().addScaledVector(new three.Vector3().fromArray(curve.direction), 0.25 * this.size));
  }

  showCursor(point, normal) {
    this.cursor.visible = true;
    this.cursor.position.copy(point).addScaledVector(normal, 0.004 * this.size);
    this.cursor.quaternion.setFromUnitVectors(new three.Vector3(0, 0, 1), normal);
  }

  show(state) {
    this.state = state;
    if (this.contacts) {
      this.contacts.show(state);
      return;
    }
    const tool = new three.Vector3().fromArray(state.tool_m);
    const force = new three.Vector3().fromArray(state.force_n);
    this.tool.position.copy(tool);
    this.tool.quaternion.fromArray(state.tool_turn);
    const hand = new three.Vector3().fromArray(state.hand_m ?? state.tool_m);
    if (this.needle) {  // held at its hub
      const grip = this.needle.grip(this.tool.quaternion);
      tool.add(grip);
      hand.add(grip);
      this.presses += this.needle.show(state) ? 1 : 0;
    }
    this.spring?.show(state);
    this.hand.visible = state.holding;
    this.hand.position.copy(hand);
    lay(this.band, tool, hand);
    this.band.visible &&= state.holding;
    const end = tool.clone().addScaledVector(force, this.metresPerNewton);
    lay(this.arrow, tool, end);
    this.head.visible = this.arrow.visible;
    this.head.position.copy(end);
    this.head.quaternion.copy(this.arrow.quaternion);
  }

  recolour() {
    this.contacts?.recolour();
    this.needle?.recolour();
    this.hand.material.color.copy(css("hand"));
    this.band.material.color.copy(css("hand"));
    this.cursor.material.color.copy(css("hand"));
    this.arrow.material.color.copy(css("force"));
    this.head.material.color.copy(css("force"));
  }

  // The body's responses have changed.
  recolourBody() {
    this.metresPerNewton = (0.6 * this.size) / this.body.text.force_max_n;
    const { color } = this.surface.geometry.attributes;
    color.array.set(vertexColours(this.body));
    color.needsUpdate = true;
    ++this.presses;
  }

  // Whether the picture would differ from the last one: without a graphics card drawing
  // costs the page most of its time.
  changed() {
    this.camera.updateMatrixWorld();
    const numbers = [this.width, this.height, ...this.camera.matrixWorld.elements, ...this.camera.projectionMatrix.elements,
                     this.presses];
    for (const mesh of [this.wire, this.normals, this.tool, this.hand, this.band, this.arrow, this.marker, this.pick, this.cursor,
                        ...(this.contacts?.moving ?? []), ...(this.spring?.parts ?? [])]) {
      numbers.push(mesh.visible ? 1 : 0, ...mesh.position.toArray(), mesh.scale.y, mesh.quaternion.x, mesh.quaternion.y);
    }
    numbers.push(this.arrow.material.color.getHex(), this.spring?.material.color.getHex() ?? 0);
    const picture = numbers.map((v) => v.toPrecision(7)).join(" ");
    const differs = picture !== this.picture;
    this.picture = picture;
    return differs;
  }

  // The body under the tool.
  yieldNow() {
    if (this.state && this.yielding.press(this.state)) {
      const { position, normal } = this.surface.geometry.attributes;
      position.needsUpdate = true;
      normal.needsUpdate = true;
      ++this.presses;
    }
  }

  redraw() { this.renderer.render(this.scene, this.camera); }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.width !== width || this.height !== height) {
      this.width = width;
      this.height = height;
      this.renderer.setSize(width, height, false);
      const aspect = width / Math.max(1, height);
      this.perspective.aspect = aspect;
      // Of a page that is higher than wide, across.
      this.perspective.fov = (360 / Math.PI) * Math.atan(Math.tan((kFovDegrees * Math.PI) / 360) / Math.min(1, aspect));
      this.perspective.updateProjectionMatrix();
    }
    if (this.camera === this.orthographic) {
      const half = this.viewHeight() / 2;
      Object.assign(this.orthographic, { top: half, bottom: -half, left: (-half * width) / height, right: (half * width) / height });
      this.orthographic.updateProjectionMatrix();
    }
    this.orbit.update();
    // From the left and above: a low light shows a shallow dimple.
    const [right, up] = this.screenAxes().map((list) => this.vector(list));
    this.lamp.position.copy(this.centre).addScaledVector(right, -2.4 * this.size).addScaledVector(up, 1.5 * this.size)
      .addScaledVector(this.vector([0, 0, 1]), 1.2 * this.size);
    this.lamp.target.position.copy(this.centre);
    this.yieldNow();
    if (this.changed()) {
      this.redraw();
    }
  }
}

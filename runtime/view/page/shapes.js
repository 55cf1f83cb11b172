// What several pictures draw with: a rod between two points, and the page's colours.
import * as three from "/vendor.min.js";

export function css(name) {
  return new three.Color(getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
}

// A cylinder of unit length along y from the origin.
export function rod(radius, material) {
  const geometry = new three.CylinderGeometry(radius, radius, 1, 20).translate(0, 0.5, 0);
  return new three.Mesh(geometry, material);
}

const kUp = new three.Vector3(0, 1, 0);

// Lays a rod from one point to another.
export function lay(mesh, from, to) {
  const along = to.clone().sub(from);
  const length = along.length();
  mesh.visible = length > 1e-6;
  mesh.position.copy(from);
  mesh.scale.set(1, Math.max(length, 1e-9), 1);
  mesh.quaternion.setFromUnitVectors(kUp, along.normalize());
}

// The tool's own shape, in its frame: +z from the tip to the handle.
import * as three from "/vendor.min.js";

const kColumns = 64;

// A piece of outline, [s, z] in turn, turned about z; smooth along itself.
function revolved(piece) {
  const position = [];
  const normal = [];
  const index = [];
  piece.forEach(([s, z], i) => {
    const [before, after] = [piece[Math.max(0, i - 1)], piece[Math.min(piece.length - 1, i + 1)]];
    const [ds, dz] = [after[0] - before[0], after[1] - before[1]];
    const length = Math.hypot(ds, dz);
    for (let k = 0; k <= kColumns; ++k) {
      const [c, d] = [Math.cos((2 * Math.PI * k) / kColumns), Math.sin((2 * Math.PI * k) / kColumns)];
      position.push(s * c, s * d, z);
      normal.push((dz / length) * c, (dz / length) * d, -ds / length);
      if (i > 0 && k > 0) {
        const at = i * (kColumns + 1) + k;
        const below = at - kColumns - 1;
        index.push(below - 1, below, at, below - 1, at, at - 1);
      }
    }
  });
  return geometryOf(position, index, normal);
}

function geometryOf(position, index, normal) {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(new Float32Array(position), 3));
  if (normal) {
    geometry.setAttribute("normal", new three.BufferAttribute(new Float32Array(normal), 3));
  }
  geometry.setIndex(index);
  return geometry;
}

// Flat faces, each with corners of its own.
function polyhedron({ position_m: position, triangle }) {
  const geometry = geometryOf(position, triangle).toNonIndexed();
  geometry.computeVertexNormals();
  return geometry;
}

// A needle's shaft from its tip, which lies `tip` below the reference point, and its hub.
export function needleGeometries(radius, tip, length) {
  const [bevel, hub] = [-tip + 5 * radius, 3.2 * radius];
  const top = length + 6 * hub;
  return [[[[0, -tip], [radius, bevel]], [[radius, bevel], [radius, length]]],
          [[[0, length], [hub, length]], [[hub, length], [hub, top]], [[hub, top], [0, top]]]]
    .map((pieces) => pieces.map(revolved));
}

export function toolGeometries(shape) {
  return shape.position_m ? [polyhedron(shape)] : shape.outline_m.map(revolved);
}

// The surface under the keys: a cursor that slides from vertex to vertex's tangent plane,
// with or without a picture of it.

const sub = (a, b) => a.map((v, k) => v - b[k]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, s = 1) => a.map((v, k) => v + s * b[k]);
const unit = (a) => { const l = Math.hypot(...a); return l > 0 ? a.map((v) => v / l) : [0, 0, 1]; };

export class Surface {
  constructor(body) {
    this.body = body;
  }

  vertex(i) { return Array.from(this.body.position.subarray(3 * i, 3 * i + 3)); }
  normal(i) { return Array.from(this.body.normal.subarray(3 * i, 3 * i + 3)); }

  // The nearest vertex with a response, or that may get one.
  nearest(p) {
    let best = -1;
    let least = Infinity;
    const { position, stiffness, text } = this.body;
    for (let i = 0; i < stiffness.length; ++i) {
      const d = (position[3 * i] - p[0]) ** 2 + (position[3 * i + 1] - p[1]) ** 2 + (position[3 * i + 2] - p[2]) ** 2;
      if (d < least && (text.served || Number.isFinite(stiffness[i]))) {
        least = d;
        best = i;
      }
    }
    return best;
  }

  // The point of the surface near p: { point, normal, node }.
  under(p) {
    const node = this.nearest(p);
    const normal = unit(this.normal(node));
    return { point: add(p, normal, -dot(sub(p, this.vertex(node)), normal)), normal, node };
  }

  // Where the tool's reference point is to go, pressed in by `depth_m`.
  target(place, depth_m) {
    return add(place.point, place.normal, this.body.height[place.node] - depth_m);
  }

  // Slides by [m] along directions of the screen, laid into the tangent plane.
  slide(place, right, up, along_m) {
    const flat = (v) => unit(add(v, place.normal, -dot(v, place.normal)));
    return this.under(add(add(place.point, flat(right), along_m[0]), flat(up), along_m[1]));
  }
}

// How the surface yields under the tool: as the database's displacement fields say,
// blended between the contact's nodes; where it holds none, by a template.

const kCacheBytes = 64e6;

const ballRadius = (tool) => (tool.kind === "mesh" ? tool.shape.half_width_m : tool.radius_m);

// Of the contact that dimple() is about [m].
function contactRadius(tool, depth) {
  return tool.kind === "flat-punch" ? tool.radius_m
    : tool.kind === "cone" ? (2 / Math.PI) * depth * Math.tan(tool.half_angle_rad)
      : Math.sqrt(ballRadius(tool) * depth);
}

// Depth of the surface at distance r from the axis of a tool pressed into an elastic
// half-space without friction: a ball (Hertz), a flat punch (Boussinesq), a sharp cone
// (Love); Johnson, Contact Mechanics, 3.4 and 5.2. Capsules and meshes: as a ball.
function dimple(tool, depth) {
  const { asin, sqrt, tan, PI } = Math;
  const a = contactRadius(tool, depth);
  if (tool.kind === "flat-punch") {
    return (r) => (r < a ? depth : (2 / PI) * depth * asin(a / r));
  }
  if (tool.kind === "cone") {
    return (r) => (r < a ? depth - r / tan(tool.half_angle_rad)
                         : (2 / PI) * depth * (asin(a / r) + (sqrt(r * r - a * a) - r) / a));
  }
  const radius = ballRadius(tool);
  return (r) => (r < a ? depth - (r * r) / (2 * radius)
                       : ((2 * a * a - r * r) * asin(a / r) + a * sqrt(r * r - a * a)) / (PI * radius));
}

// Sums of the triangles' normals at each vertex, as unit vectors.
function normalsOf(position, triangle) {
  const sum = new Float32Array(position.length);
  for (let t = 0; t < triangle.length; t += 3) {
    const a = 3 * triangle[t], b = 3 * triangle[t + 1], c = 3 * triangle[t + 2];
    const ux = position[b] - position[a], uy = position[b + 1] - position[a + 1], uz = position[b + 2] - position[a + 2];
    const vx = position[c] - position[a], vy = position[c + 1] - position[a + 1], vz = position[c + 2] - position[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    sum[a] += nx; sum[a + 1] += ny; sum[a + 2] += nz;
    sum[b] += nx; sum[b + 1] += ny; sum[b + 2] += nz;
    sum[c] += nx; sum[c + 1] += ny; sum[c + 2] += nz;
  }
  return unit(sum);
}

function unit(rows) {
  for (let i = 0; i < rows.length; i += 3) {
    const length = Math.sqrt(rows[i] ** 2 + rows[i + 1] ** 2 + rows[i + 2] ** 2) || 1;
    rows[i] /= length;
    rows[i + 1] /= length;
    rows[i + 2] /= length;
  }
  return rows;
}

function steps(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Int16Array(bytes.buffer);
}

export class Yielding {
  // @param reach [m] at which a template has faded out: the body is held somewhere.
  // @param ask called with a node whose field is needed; the answer goes to take().
  constructor(body, reach, ask) {
    Object.assign(this, { body, reach, ask });
    this.position = body.position.slice();  // as the surface is now
    this.normal = body.normal.slice();
    this.flat = normalsOf(body.position, body.triangle);
    this.fields = new Map();  // of nodes, the last one used last; null: none is stored
    this.asked = -1;
    this.stored = 0;  // share of the dimple that is the database's
    this.drawn = "";
  }

  take(field) {
    this.asked = -1;
    this.drawn = "";
    this.fields.set(field.node, field.depth_m === null ? null
      : { depth_m: field.depth_m, scale_m: field.scale_m, step: steps(field.displacement) });
    const most = Math.max(8, kCacheBytes / (2 * this.position.length));
    if (this.fields.size > most) {
      this.fields.delete(this.fields.keys().next().value);
    }
  }

  // The connection is new: what was asked before is not answered.
  forget() { this.asked = -1; }

  // The fields under a point with these area coordinates, each with its share; null is
  // the template. While a field is on its way the others take its place.
  parts(nodes, shares) {
    if (this.body.text.displacement_fields === 0 || nodes[0] < 0) {
      return [[null, 1]];
    }
    const corners = nodes.map((node, j) => [node, shares[j]]).filter(([, share]) => share > 0).sort((a, b) => b[1] - a[1]);
    const missing = corners.find(([node]) => !this.fields.has(node));
    if (missing && this.asked < 0) {
      [this.asked] = missing;
      this.ask(this.asked);
    }
    const known = corners.filter(([node]) => this.fields.has(node));
    const sum = known.reduce((all, [, share]) => all + share, 0);
    return known.length === 0 ? [[null, 1]] : known.map(([node, share]) => {
      const field = this.fields.get(node);
      this.fields.delete(node);
      this.fields.set(node, field);
      return [field, share / sum];
    });
  }

  // The surface under the tools; true if it has changed. A contact of several sinks it
  // by what its own force does, and they add up; fields are of the first tool's sphere.
  press(state) {
    const { dents } = state;
    const { tool } = this.body.text;
    const { anchor, stretch_m: stretch } = state.friction ?? {};  // of a contact that rubs
    const pressed = state.contacts
      ? state.contacts.filter(({ own_m }) => own_m > 0).map(({ radius_m, nodes, shares, point_m: point, normal, own_m: depth }) =>
        ({ nodes: radius_m === tool.radius_m ? nodes : [-1, -1, -1], shares, point, normal, depth, tool: { kind: "sphere", radius_m } }))
      : anchor ? [{ ...anchor, point: anchor.point_m, depth: state.penetration_m, tool, stretch }]
        : [{ nodes: state.contact_nodes, shares: state.contact_shares, point: state.contact_m, normal: state.normal, depth: state.penetration_m, tool }];
    const parts = pressed.map(({ nodes, shares }) => this.parts(nodes, shares));
    const drawn = pressed.map(({ nodes, shares, point, normal, depth, stretch: by }) => (depth > 0 ? [nodes, shares, point, normal, depth, by].join() : "")).join() +
      dents.depth_m.map((d) => d.toPrecision(3)).join();
    const stored = parts.map((each) => each.reduce((all, [field, share]) => all + (field ? share : 0), 0));
    if (stored.length > 0) {
      this.stored = stored.reduce((all, share) => all + share, 0) / stored.length;
    }
    if (drawn === this.drawn) {
      return false;
    }
    this.drawn = drawn;
    this.position.set(this.body.position);
    pressed.forEach(({ point, normal, depth, tool: shape, stretch: by }, i) => {
      if (depth > 0) {
        for (const [field, share] of parts[i]) {
          if (field) {
            this.addField(field, share * depth);
          }
        }
        this.addTemplate(shape, point, normal, depth, 1 - stored[i]);
        this.addShear(contactRadius(shape, depth), point, by ?? [0, 0, 0]);
      }
    });
    this.addDents(dents);
    this.turnNormals();
    return true;
  }

  // What earlier presses have left: nodes that the tool does not hold deeper lie so deep.
  addDents({ node, depth_m }) {
    const { position, body: { position: rest, normal } } = this;
    node.forEach((at, j) => {
      const i = 3 * at;
      let in_m = 0;
      for (let k = 0; k < 3; ++k) {
        in_m -= (position[i + k] - rest[i + k]) * normal[i + k];
      }
      const more = Math.max(0, depth_m[j] - in_m);
      for (let k = 0; k < 3; ++k) {
        position[i + k] -= more * normal[i + k];
      }
    });
  }

  // As FORMAT.md has it: in proportion to the normal penetration.
  addField({ depth_m: at, scale_m: scale, step }, depth) {
    const { position } = this;
    const factor = (depth / at) * scale;
    for (let i = 0; i < position.length; ++i) {
      position[i] += factor * step[i];
    }
  }

  addTemplate(tool, point, normal, depth, share) {
    if (!(share > 1e-6)) {
      return;
    }
    const { position, reach, body: { position: rest } } = this;
    const sink = dimple(tool, depth);
    for (let i = 0; i < position.length; i += 3) {
      const r = Math.sqrt((rest[i] - point[0]) ** 2 + (rest[i + 1] - point[1]) ** 2 + (rest[i + 2] - point[2]) ** 2);
      const x = Math.min(1, Math.max(0, (r / reach - 0.25) / 0.75));
      const down = share * sink(r) * (1 - x * x * (3 - 2 * x));
      for (let k = 0; k < 3; ++k) {
        position[i + k] -= down * normal[k];
      }
    }
  }

  // A contact that sticks takes the surface with it: a disc moved sideways on a half-space
  // without Poisson's effect, whose profile is that of a punch pressed in.
  addShear(radius, point, stretch) {
    const length = Math.hypot(...stretch);
    if (length > 0) {
      this.addTemplate({ kind: "flat-punch", radius_m: radius }, point, stretch.map((v) => -v / length), length, 1);
    }
  }

  // The database's own normals, turned as far as the triangles have turned.
  turnNormals() {
    const { normal, flat, body } = this;
    const now = normalsOf(this.position, body.triangle);
    for (let i = 0; i < normal.length; ++i) {
      normal[i] = body.normal[i] + now[i] - flat[i];
    }
    unit(normal);
  }

  label() {
    const template = "illustrative template (elastic half-space)";
    if (this.body.text.displacement_fields === 0) {
      return `Dimple: ${template}; the database holds no displacements.`;
    }
    const share = Math.round(100 * this.stored);
    return share === 100 ? "Dimple: computed displacement, interpolated between nodes and in depth."
      : share === 0 ? `Dimple: ${template}; ${this.asked < 0 ? "no displacement is stored here" : "the stored one is on its way"}.`
        : `Dimple: ${share} % computed displacement, else ${template}.`;
  }
}

// A contact that rubs, beside the picture: whether it sticks or slips, and the loop of
// lateral force against lateral displacement.
import { PathPlot } from "/path_plot.js";
import { colour, kWindowS } from "/plots.js";

const kStep = 0.02;      // between points, of the limit and of the stretch that reaches it
const kNoneM = 1e-5;     // [m] a movement below it has no direction

const get = (id) => document.getElementById(id);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const threes = (list) => Array.from({ length: list.length / 3 }, (_, i) => list.slice(3 * i, 3 * i + 3));

// The direction along which points lie farthest apart, its largest part positive: the
// first principal axis, by power iteration. Null where they lie together.
export function principalAxis(points) {
  const mean = [0, 1, 2].map((k) => points.reduce((all, p) => all + p[k], 0) / Math.max(1, points.length));
  const spread = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  let axis = [0, 0, 0];  // the farthest, to begin with
  for (const p of points) {
    const away = p.map((v, k) => v - mean[k]);
    axis = dot(away, away) > dot(axis, axis) ? away : axis;
    away.forEach((v, i) => away.forEach((w, j) => { spread[i][j] += v * w; }));
  }
  if (Math.hypot(...axis) < kNoneM) {
    return null;
  }
  for (let i = 0; i < 50; ++i) {
    const next = spread.map((row) => dot(row, axis));
    const length = Math.hypot(...next);
    axis = next.map((v) => v / length);
  }
  const sign = Math.sign(axis.reduce((most, v) => (Math.abs(v) > Math.abs(most) ? v : most), 0));
  return axis.map((v) => sign * v);
}

// Lateral force of the tool on the body against what the tool has slid since the contact
// began. Both are parts along the principal axis of the movement that is shown.
export class LateralPlot extends PathPlot {
  constructor(parent) {
    super(parent, "Lateral force [N] along the movement");
  }

  clear() {
    this.points = [];  // { slid, force (on the body), time }, a contact's alone
    this.tip = null;   // the latest, which may be no point of its own
    this.axis = null;
    this.now = null;   // friction, as a frame has it
    this.fresh = true;
  }

  // From the runtime: the ticks of a frame.
  take({ friction, trace, run }) {
    if (run.ticks < (this.ticks ?? 0)) {  // a new run
      this.clear();
    }
    this.ticks = run.ticks;
    this.now = friction;
    const { slid_m: slid, force_n: force, limit_n: limits } = friction.trace;
    const [slides, forces] = [threes(slid), threes(force)];
    const time = trace.time_s.at(-1) ?? 0;
    limits.forEach((limit, i) => {
      if (slides[i].every((v) => v === 0)) {
        this.points = [];  // another contact
      }
      this.add({ slid: slides[i], force: forces[i].map((v) => -v), time }, limit);
    });
    if (limits.length > 0) {
      this.points = this.points.filter((point) => point.time > time - kWindowS);
      this.axis = principalAxis(this.points.map((point) => point.slid)) ?? this.axis;
      this.fresh = true;
    }
  }

  add(point, limit) {
    const last = this.points.at(-1);
    const off = (key) => Math.hypot(...point[key].map((v, k) => v - last[key][k]));
    if (!last || off("force") > kStep * limit || off("slid") > kStep * (limit / this.now.n_per_m || kNoneM)) {
      this.points.push(point);
    }
    this.tip = point;
  }

  // [mm, N] along the axis.
  get loop() {
    return this.axis && this.tip ? [...this.points, this.tip].map(({ slid, force }) => [1e3 * dot(slid, this.axis), dot(force, this.axis)]) : [];
  }

  range() {
    let [left, right, most] = [Infinity, -Infinity, 0.02];
    for (const [mm, force] of this.loop) {
      [left, right, most] = [Math.min(left, mm), Math.max(right, mm), Math.max(most, Math.abs(force))];
    }
    most = Math.max(most, this.now?.limit_n ?? 0);
    if (!(right >= left)) {
      [left, right] = [-0.5, 0.5];
    }
    const margin = Math.max(0.25 - 0.5 * (right - left), 0.06 * (right - left));
    return { x: [left - margin, right + margin], y: [-1.35 * most, 1.35 * most] };
  }

  // Coulomb's limit of now, and the slope of the contact that sticks, through its anchor.
  drawBehind() {
    const { x } = this.range();
    const { limit_n: limit, n_per_m: stiffness, stretch_m: stretch } = this.now ?? {};
    if (!(limit > 0) || !this.axis) {
      return;
    }
    this.clipped(() => {
      for (const side of [-limit, limit]) {
        this.path([[x[0], side], [x[1], side]], "warn", { dash: [4, 3], width: 1, alpha: 0.9 });
      }
      const anchor = this.loop.at(-1)[0] - 1e3 * dot(stretch, this.axis);
      const reach = (1e3 * limit) / stiffness;
      this.path([[anchor - reach, -limit], [anchor + reach, limit]], "dim", { dash: [2, 3] });
    });
  }

  // At the frame's left edge, above the upper limit or below the lower one.
  label(text, name, force) {
    const { ctx } = this.plot;
    const [left, high] = this.pixel([this.range().x[0], force]);
    ctx.fillStyle = colour(name);
    ctx.fillText(text, left + 4 * devicePixelRatio, high - Math.sign(force) * 8 * devicePixelRatio);
  }

  drawPaths() {
    const { loop } = this;
    this.path(loop, "force");
    if (loop.length > 0 && this.now.limit_n > 0) {
      const { limit_n: limit, n_per_m: stiffness } = this.now;
      this.label(`μ N = ${limit.toPrecision(2)} N`, "warn", limit);
      this.label(`k = ${stiffness.toPrecision(3)} N/m`, "dim", -limit);
      this.disc(loop.at(-1), "hand");
    }
  }
}

// What share of Coulomb's limit a contact's spring bears, [0, 1].
export function shareOfLimit({ force_n: force, limit_n: limit }) {
  return limit > 0 ? Math.min(1, Math.hypot(...force) / limit) : 0;
}

export class Friction {
  constructor() {
    for (const part of document.querySelectorAll(".of_friction")) {
      part.hidden = false;
    }
    this.plot = new LateralPlot(get("lateral_plot"));
  }

  // @param put (id, text) writes where it differs.
  show({ friction }, put) {
    const { state, stretch_m: stretch, force_n: force } = friction;
    put("rubs", state === "sticks" ? `sticks, ${shareOfLimit(friction).toFixed(2)} of the limit`
      : state === "slips" ? "slips" : "–");
    put("lateral_mm", (1e3 * Math.hypot(...stretch)).toFixed(2));
    put("lateral_n", Math.hypot(...force).toFixed(3));
  }
}

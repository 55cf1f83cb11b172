// Force along a needle against the depth of its tip, as it is made: layers as bands, and
// where membranes broke.
import { PathPlot } from "/path_plot.js";
import { colour } from "/plots.js";

const kPasses = 4;      // that are shown, the last one clearly
const kPoints = 3000;   // of each
const kStepMm = 0.02;   // between points, or ...
const kStepN = 0.002;

export class NeedlePlot extends PathPlot {
  constructor(parent, puncture) {
    super(parent, "Force along the needle [N] against depth of the tip");
    this.puncture = puncture;
  }

  clear() {
    this.passes = [];
    this.inside = false;
    this.channel = null;  // whose layers are shown: the one that the needle is or was in
    this.marks = [];      // { depth_mm, force_n, material } of membranes that broke there
    this.fresh = true;
  }

  // From the runtime: the ticks of a frame.
  take({ needle, trace, run }) {
    if (run.ticks < (this.ticks ?? 0)) {  // a new run
      this.clear();
    }
    this.ticks = run.ticks;
    trace.depth_m.forEach((depth, i) => this.add(1e3 * depth, trace.axial_n[i]));
    this.channel = needle.channels[needle.in] ?? this.shown(needle);
    this.marks = (this.channel?.broke_m ?? []).map((depth, k) =>
      ({ depth_mm: 1e3 * depth, force_n: this.channel.broke_n[k], material: this.channel.materials[k] }))
      .filter((mark) => mark.force_n !== null);  // of this run
    this.fresh ||= trace.depth_m.length > 0;
  }

  // The channel that was shown before, or the latest one.
  shown({ channels }) {
    return channels.find(({ entry_m: entry }) => `${entry}` === `${this.channel?.entry_m}`) ?? channels.at(-1) ?? null;
  }

  add(depth_mm, force_n) {
    if (depth_mm <= 0 && Math.abs(force_n) < 1e-6) {
      this.inside = false;
      return;
    }
    if (!this.inside) {
      this.inside = true;
      this.passes.push([]);
      this.passes = this.passes.slice(-kPasses);
    }
    const pass = this.passes.at(-1);
    const last = pass.at(-1);
    if (!last || Math.abs(depth_mm - last[0]) > kStepMm || Math.abs(force_n - last[1]) > kStepN) {
      pass.push([depth_mm, force_n]);
      if (pass.length > kPoints) {
        pass.splice(0, pass.length - kPoints);
      }
    }
  }

  range() {
    const points = [...this.passes.flat(), ...this.marks.map((mark) => [mark.depth_mm, mark.force_n])];
    let [deep, high, low] = [5, 0.2, 0];
    for (const [depth, force] of points) {
      [deep, high, low] = [Math.max(deep, depth), Math.max(high, force), Math.min(low, force)];
    }
    const layers = this.channel?.layers_m ?? [];
    return { x: [0, 1.06 * Math.max(deep, 1.1e3 * (layers.at(-1) ?? 0))], y: [1.15 * low, 1.15 * high] };
  }

  // Bands and boundaries of the layers below the place.
  drawBehind() {
    if (!this.channel) {
      return;
    }
    const { ctx, bbox: { left, top, width, height } } = this.plot;
    const ratio = devicePixelRatio;
    const { layers_m: begins, materials } = this.channel;
    const at = (mm) => Math.min(left + width, Math.max(left, this.plot.valToPos(mm, "x", true)));
    ctx.save();
    ctx.font = `${11 * ratio}px system-ui, sans-serif`;
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    begins.forEach((begin, k) => {
      const [from, to] = [at(1e3 * begin), k + 1 < begins.length ? at(1e3 * begins[k + 1]) : left + width];
      const tint = colour(`layer${materials[k] % 8}`);
      ctx.fillStyle = tint;
      ctx.globalAlpha = 0.16;
      ctx.fillRect(from, top, to - from, height);
      ctx.globalAlpha = 0.9;
      ctx.strokeStyle = tint;
      ctx.lineWidth = ratio;
      ctx.setLineDash([4 * ratio, 3 * ratio]);
      ctx.beginPath();
      ctx.moveTo(from, top);
      ctx.lineTo(from, top + height);
      ctx.stroke();
      const name = this.puncture.materials[materials[k]];
      if (ctx.measureText(name).width < to - from - 6 * ratio) {
        ctx.fillText(name, from + 4 * ratio, top + 9 * ratio);
      }
    });
    ctx.restore();
  }

  drawPaths() {
    this.passes.forEach((pass, i) => {
      this.path(pass, "force", { alpha: i + 1 === this.passes.length ? 1 : 0.35 });
    });
    const { ctx } = this.plot;
    for (const { depth_mm: mm, force_n: force, material } of this.marks) {
      const [x, y] = this.pixel([mm, force]);
      this.disc([mm, force], `layer${material % 8}`);
      ctx.fillStyle = colour("text");
      ctx.fillText(force.toFixed(2), x + 7 * devicePixelRatio, y);
    }
    const now = this.inside ? this.passes.at(-1)?.at(-1) : null;
    if (now) {
      this.disc(now, "hand");
    }
  }
}

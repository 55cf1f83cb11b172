// Force against displacement as a path that is made while one looks: frame, path, discs.
import { uPlot } from "/vendor.min.js";
import { axis, colour, titled } from "/plots.js";

export class PathPlot {
  // @param title of the plot; a child has range(), drawBehind() and drawPaths().
  constructor(parent, title) {
    this.parent = parent;
    this.title = title;
    this.clear();
    this.build();
  }

  build() {
    this.parent.replaceChildren();
    const range = (name) => () => this.range()[name];
    this.plot = new uPlot({
      width: Math.max(240, this.parent.clientWidth - 2), height: 172, legend: { show: false }, cursor: { show: false },
      padding: [8, 16, 0, 0],
      scales: { x: { time: false, range: range("x") }, y: { range: range("y") } },
      axes: [axis({ size: 26, values: (_, v) => v.map((mm) => `${mm} mm`) }), axis({ size: 46, space: 26 })],
      series: [{}, { paths: () => null, points: { show: false } }],
      hooks: { drawClear: [() => this.drawBehind()], draw: [() => this.clipped(() => this.drawPaths())] },
    }, [[0, 1], [0, 1]], titled(this.parent, this.title));
    this.fresh = true;
  }

  draw() {
    if (this.fresh) {
      this.fresh = false;
      const { x, y } = this.range();
      this.plot.setData([x, y]);
    }
  }

  pixel([mm, force]) { return [this.plot.valToPos(mm, "x", true), this.plot.valToPos(force, "y", true)]; }

  // Draws what lies in the frame alone, with the labels' font.
  clipped(draw) {
    const { ctx, bbox: { left, top, width, height } } = this.plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.font = `600 ${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = "left";
    ctx.textBaseline = "middle";
    draw();
    ctx.restore();
  }

  // @param dash [pixels] on and off; none: a whole line
  path(points, name, { width = 1.5, alpha = 1, dash = [] } = {}) {
    const { ctx } = this.plot;
    ctx.strokeStyle = colour(name);
    ctx.lineWidth = width * devicePixelRatio;
    ctx.globalAlpha = alpha;
    ctx.setLineDash(dash.map((length) => length * devicePixelRatio));
    ctx.beginPath();
    points.forEach((point) => ctx.lineTo(...this.pixel(point)));
    ctx.stroke();
    ctx.globalAlpha = 1;
    ctx.setLineDash([]);
  }

  disc(point, name) {
    const { ctx } = this.plot;
    const radius = 4 * devicePixelRatio;
    ctx.beginPath();
    ctx.arc(...this.pixel(point), radius, 0, 2 * Math.PI);
    ctx.fillStyle = colour(name);
    ctx.fill();
    ctx.strokeStyle = colour("ground");
    ctx.lineWidth = 0.3 * radius;
    ctx.stroke();
  }
}

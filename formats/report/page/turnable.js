// The part of a report's script that draws a body and lets the user turn it, by a
// z-buffer of its own, so that a page needs neither a graphics card nor a library.
// Comes after figures.js.
//
// The page gives the elements info (JSON with `box` and `colours`), position, normal,
// triangle and the canvas body; and, in the script after this one:
// colourOf(a, b, c, wa, wb, wc), the colour between three nodes; drawMarks(scale, deep),
// over the body; clicked(x, y), a place of the window; keys, what further keys do;
// redraw() to begin with.
const info = JSON.parse(document.getElementById('info').textContent);
const $ = id => document.getElementById(id);
const bytesOf = id => Uint8Array.from(atob($(id).textContent.trim()), c => c.charCodeAt(0));
const f32 = id => new Float32Array(bytesOf(id).buffer);
const i32 = id => new Int32Array(bytesOf(id).buffer);
const position = f32('position'), normal = f32('normal'), triangle = i32('triangle');
const n = position.length / 3;
const viridis = colourRamp(info.colours);
const table = Array.from({length: 256}, (_, i) => viridis(i / 255));
const turned = {angle: [0.6, -1.1], zoom: 1};

const canvas = $('body'), context = canvas.getContext('2d', {willReadFrequently: true});
let corner = new Float32Array(3 * n), light = new Float32Array(n), hit = null, width = 0, height = 0;
const middle = [0, 1, 2].map(j => (info.box[0][j] + info.box[1][j]) / 2);
let radius = 1e-9;
for (let i = 0; i < n; ++i) radius = Math.max(radius, Math.hypot(...[0, 1, 2].map(j => position[3 * i + j] - middle[j])));

// Places to pixels and nearness: z up, turned about z and then about the picture's x.
let axes = null, centre = null, size = 1;
function pixelOf(p, i = 0) {
  const dot = a => a[0] * p[3 * i] + a[1] * p[3 * i + 1] + a[2] * p[3 * i + 2];
  return [width / 2 + size * (dot(axes[0]) - centre[0]), height / 2 - size * (dot(axes[1]) - centre[1]),
    dot(axes[2]) - centre[2]];
}
function project() {
  const [u, v] = turned.angle, cu = Math.cos(u), su = Math.sin(u), cv = Math.cos(v), sv = Math.sin(v);
  axes = [[cu, su, 0], [-su * cv, cu * cv, -sv], [-su * sv, cu * sv, cv]];
  size = 0.48 * Math.min(width, height) / radius * turned.zoom;
  const dot = (a, p, i) => a[0] * p[3 * i] + a[1] * p[3 * i + 1] + a[2] * p[3 * i + 2];
  centre = axes.map(a => a[0] * middle[0] + a[1] * middle[1] + a[2] * middle[2]);
  for (let i = 0; i < n; ++i) {
    corner.set(pixelOf(position, i), 3 * i);
    const across = dot(axes[0], normal, i), up = dot(axes[1], normal, i), near = dot(axes[2], normal, i);
    light[i] = 0.5 + 0.5 * Math.abs(-0.35 * across + 0.45 * up + 0.82 * near);
  }
}

function fill(image, t, deep) {
  const [a, b, c] = [triangle[3 * t], triangle[3 * t + 1], triangle[3 * t + 2]];
  const [ax, ay, bx, by, cx, cy] = [corner[3 * a], corner[3 * a + 1], corner[3 * b], corner[3 * b + 1],
    corner[3 * c], corner[3 * c + 1]];
  const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
  if (Math.abs(area) < 1e-9) return;
  const x0 = Math.max(0, Math.ceil(Math.min(ax, bx, cx) - 0.5)), y0 = Math.max(0, Math.ceil(Math.min(ay, by, cy) - 0.5));
  const x1 = Math.min(width - 1, Math.floor(Math.max(ax, bx, cx) - 0.5)), y1 = Math.min(height - 1, Math.floor(Math.max(ay, by, cy) - 0.5));
  const az = corner[3 * a + 2], bz = corner[3 * b + 2], cz = corner[3 * c + 2];
  for (let y = y0; y <= y1; ++y) for (let x = x0; x <= x1; ++x) {
    const px = x + 0.5, py = y + 0.5;
    const wb = ((px - ax) * (cy - ay) - (cx - ax) * (py - ay)) / area;
    const wc = ((bx - ax) * (py - ay) - (px - ax) * (by - ay)) / area, wa = 1 - wb - wc;
    if (wa < 0 || wb < 0 || wc < 0) continue;
    const z = wa * az + wb * bz + wc * cz, at = y * width + x;
    if (z <= deep[at]) continue;
    deep[at] = z;
    hit[at] = t;
    const colour = colourOf(a, b, c, wa, wb, wc);
    const shade = wa * light[a] + wb * light[b] + wc * light[c];
    image[4 * at] = shade * colour[0];
    image[4 * at + 1] = shade * colour[1];
    image[4 * at + 2] = shade * colour[2];
    image[4 * at + 3] = 255;
  }
}

function draw(scale) {
  const box = canvas.getBoundingClientRect();
  width = canvas.width = Math.max(1, Math.round(box.width * scale));
  height = canvas.height = Math.max(1, Math.round(box.height * scale));
  project();
  const image = context.createImageData(width, height);
  const deep = new Float32Array(width * height).fill(-Infinity);
  hit = new Int32Array(width * height).fill(-1);
  for (let t = 0; t < triangle.length / 3; ++t) fill(image.data, t, deep);
  context.putImageData(image, 0, 0);
  drawMarks(scale, deep);
}
let pending = 0;
function redraw() {  // at once coarsely, finely when nothing moves
  draw(1);
  clearTimeout(pending);
  pending = setTimeout(() => draw(2), 150);
}

// The node nearest to a place of the canvas, -1 off the body.
function nodeAt(x, y) {
  const box = canvas.getBoundingClientRect(), sx = width / box.width, sy = height / box.height;
  const px = (x - box.left) * sx, py = (y - box.top) * sy, t = hit[Math.floor(py) * width + Math.floor(px)];
  if (!(t >= 0)) return -1;
  const far = i => Math.hypot(corner[3 * i] - px, corner[3 * i + 1] - py);
  return [0, 1, 2].map(j => triangle[3 * t + j]).reduce((a, b) => far(a) < far(b) ? a : b);
}
function turn(dx, dy) {
  turned.angle[0] += dx;
  turned.angle[1] = Math.min(0.1, Math.max(-Math.PI, turned.angle[1] + dy));
  redraw();
}
function zoom(factor) {
  turned.zoom = Math.min(20, Math.max(0.3, turned.zoom * factor));
  redraw();
}
let from = null;
canvas.addEventListener('pointerdown', e => { from = {x: e.clientX, y: e.clientY, moved: 0}; });
window.addEventListener('pointermove', e => {
  if (!from) return;
  const dx = e.clientX - from.x, dy = e.clientY - from.y;
  from = {x: e.clientX, y: e.clientY, moved: from.moved + Math.abs(dx) + Math.abs(dy)};
  if (from.moved > 3) turn(-0.008 * dx, -0.008 * dy);
});
window.addEventListener('pointerup', e => {
  if (from && from.moved <= 3) clicked(e.clientX, e.clientY);
  from = null;
});
canvas.addEventListener('wheel', e => { e.preventDefault(); zoom(Math.exp(-0.0015 * e.deltaY)); }, {passive: false});
canvas.addEventListener('keydown', e => {
  const act = {ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, 0.1),
    ArrowDown: () => turn(0, -0.1), '+': () => zoom(1.2), '=': () => zoom(1.2), '-': () => zoom(1 / 1.2),
    Home: () => { turned.angle = [0.6, -1.1]; zoom(1 / turned.zoom); }, ...keys}[e.key];
  if (act) { e.preventDefault(); act(); }
});
window.addEventListener('resize', redraw);

// The page's own program. It draws the body by a z-buffer of its own, so that a page
// needs neither a graphics card nor a library.
#include "formats/report_text.h"

namespace palpate {

const char* const report_script = R"js('use strict';
const info = JSON.parse(document.getElementById('info').textContent);
const $ = id => document.getElementById(id);
const bytesOf = id => Uint8Array.from(atob($(id).textContent.trim()), c => c.charCodeAt(0));
const f32 = id => new Float32Array(bytesOf(id).buffer);
const i32 = id => new Int32Array(bytesOf(id).buffer);
const position = f32('position'), normal = f32('normal'), triangle = i32('triangle');
const nodeName = i32('node'), n = nodeName.length;
const tools = info.tools.map((t, k) => ({...t, begin: i32(`begin${k}`), depth: f32(`depth${k}`),
  force: f32(`force${k}`), slope: f32(`slope${k}`), slopeMax: f32(`slopemax${k}`),
  error: f32(`error${k}`), verified: f32(`verified${k}`), origin: bytesOf(`origin${k}`)}));
const origins = ['none', 'simulated', 'interpolated', 'measured'];
const originColour = [[200, 200, 200], [0, 114, 178], [230, 159, 0], [0, 158, 115]];
const stops = [[68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140],
  [34, 168, 132], [68, 191, 112], [122, 209, 81], [189, 223, 38], [253, 231, 37]];
const viridis = t => {
  const at = Math.min(Math.max(t, 0), 1) * 10, i = Math.min(9, Math.floor(at)), r = at - i;
  return stops[i].map((c, j) => c * (1 - r) + stops[i + 1][j] * r);
};
const table = Array.from({length: 256}, (_, i) => viridis(i / 255));
const tell = (x, digits = 3) => Number.isFinite(x) ? String(+x.toPrecision(digits)) : '–';

// Force [N] and slope [N/m] of node i at depth d [m]: the file's own cubic.
function response(tool, i, d) {
  const a = tool.begin[i], b = tool.begin[i + 1], D = tool.depth, F = tool.force, M = tool.slope;
  if (a === b) return null;
  if (d > D[b - 1]) return {force: F[b - 1] + M[b - 1] * (d - D[b - 1]), extrapolated: true};
  let k = a;
  while (k < b - 2 && D[k + 1] < d) ++k;
  const h = D[k + 1] - D[k], x = (d - D[k]) / h, s = (F[k + 1] - F[k]) / h, m = M[k], e = M[k + 1];
  return {force: F[k] + h * x * (m + x * (3 * s - 2 * m - e + x * (m + e - 2 * s))), extrapolated: false};
}

const state = {tool: 0, colour: 'stiffness', depth: 0, node: -1, turn: [0.6, -1.1], zoom: 1};
const kinds = {
  stiffness: {name: 'stiffness f/d at the depth', unit: 'N/m',
    at: (t, i) => { const r = response(t, i, state.depth); return r ? r.force / state.depth : NaN; }},
  slope: {name: 'largest slope', unit: 'N/m', at: (t, i) => t.begin[i] < t.begin[i + 1] ? t.slopeMax[i] : NaN},
  depth: {name: 'largest depth', unit: 'mm', at: (t, i) => t.begin[i] < t.begin[i + 1] ? 1e3 * t.depth[t.begin[i + 1] - 1] : NaN},
  error: {name: 'estimated error of force', unit: '%', at: (t, i) => t.origin[i] ? 100 * t.error[i] : NaN},
  verified: {name: 'verified error of force', unit: '%', at: (t, i) => t.verified.length ? 100 * t.verified[i] : NaN},
  origin: {name: 'origin', unit: '', at: (t, i) => t.origin[i]},
};
let value = new Float32Array(n), range = [0, 1];

function evaluate() {
  const tool = tools[state.tool], at = kinds[state.colour].at;
  for (let i = 0; i < n; ++i) value[i] = at(tool, i);
  const known = value.filter(Number.isFinite).sort();
  const pick = q => known.length ? known[Math.round(q * (known.length - 1))] : 0;
  let [low, high] = [pick(0.02), pick(0.98)];
  const missing = Math.max(0.1 * Math.abs(high), 1e-9) - (high - low);  // rounding is no colour
  if (missing > 0) { low -= missing / 2; high += missing / 2; }
  range = [low, high];
  drawLegend(known);
  drawCurve();
  redraw();
}
const place = v => (v - range[0]) / (range[1] - range[0]);
const css = c => `rgb(${c.map(Math.round).join()})`;

const canvas = $('body'), context = canvas.getContext('2d', {willReadFrequently: true});
let corner = new Float32Array(3 * n), light = new Float32Array(n), hit = null, width = 0, height = 0;
const middle = [0, 1, 2].map(j => (info.box[0][j] + info.box[1][j]) / 2);
let radius = 1e-9;
for (let i = 0; i < n; ++i) radius = Math.max(radius, Math.hypot(...[0, 1, 2].map(j => position[3 * i + j] - middle[j])));

// Vertices to pixels: z up, turned about z and then about the picture's x.
function project() {
  const [u, v] = state.turn, cu = Math.cos(u), su = Math.sin(u), cv = Math.cos(v), sv = Math.sin(v);
  const axes = [[cu, su, 0], [-su * cv, cu * cv, -sv], [-su * sv, cu * sv, cv]];
  const size = 0.48 * Math.min(width, height) / radius * state.zoom;
  const dot = (a, p, i) => a[0] * p[3 * i] + a[1] * p[3 * i + 1] + a[2] * p[3 * i + 2];
  const at = axes.map(a => a[0] * middle[0] + a[1] * middle[1] + a[2] * middle[2]);
  for (let i = 0; i < n; ++i) {
    corner[3 * i] = width / 2 + size * (dot(axes[0], position, i) - at[0]);
    corner[3 * i + 1] = height / 2 - size * (dot(axes[1], position, i) - at[1]);
    corner[3 * i + 2] = dot(axes[2], position, i) - at[2];
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
  const az = corner[3 * a + 2], bz = corner[3 * b + 2], cz = corner[3 * c + 2], sorted = state.colour === 'origin';
  for (let y = y0; y <= y1; ++y) for (let x = x0; x <= x1; ++x) {
    const px = x + 0.5, py = y + 0.5;
    const wb = ((px - ax) * (cy - ay) - (cx - ax) * (py - ay)) / area;
    const wc = ((bx - ax) * (py - ay) - (px - ax) * (by - ay)) / area, wa = 1 - wb - wc;
    if (wa < 0 || wb < 0 || wc < 0) continue;
    const z = wa * az + wb * bz + wc * cz, at = y * width + x;
    if (z <= deep[at]) continue;
    deep[at] = z;
    hit[at] = t;
    const nearest = wa > wb ? (wa > wc ? a : c) : (wb > wc ? b : c);
    let colour = originColour[0];
    if (sorted) colour = originColour[value[nearest]];
    else {
      const v = wa * value[a] + wb * value[b] + wc * value[c];
      if (Number.isFinite(v)) colour = table[Math.min(255, Math.max(0, Math.round(255 * place(v))))];
    }
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
  if (state.node >= 0) {
    const x = corner[3 * state.node], y = corner[3 * state.node + 1], z = corner[3 * state.node + 2];
    const at = Math.round(y) * width + Math.round(x);
    context.globalAlpha = z < deep[at] - 0.03 * radius ? 0.35 : 1;  // behind the body
    for (const [colour, wide] of [['#fff', 5], ['#d00', 2.5]]) {
      context.beginPath();
      context.arc(x, y, 7 * scale, 0, 7);
      context.lineWidth = wide * scale;
      context.strokeStyle = colour;
      context.stroke();
    }
    context.globalAlpha = 1;
  }
}
let pending = 0;
function redraw() {  // at once coarsely, finely when nothing moves
  draw(1);
  clearTimeout(pending);
  pending = setTimeout(() => draw(2), 150);
}

function ticks(low, high, wanted) {
  const raw = (high - low) / wanted || 1, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= raw * (1 - 1e-9)), list = [];
  for (let k = Math.ceil(low / step - 1e-5); k * step <= high + 1e-5 * step; ++k) list.push(k * step);
  return list;
}
// An empty plot and its scales: x and y from and to, names of the axes.
function plot(id, x, y, xName, yName) {
  const W = 460, H = 250, l = 62, r = 12, t = 12, b = 42;
  const px = v => l + (v - x[0]) / (x[1] - x[0] || 1) * (W - l - r);
  const py = v => H - b - (v - y[0]) / (y[1] - y[0] || 1) * (H - t - b);
  let svg = '';
  for (const v of ticks(x[0], x[1], 6)) svg += `<line class="grid" x1="${px(v)}" x2="${px(v)}" y1="${t}" y2="${H - b}"/><text x="${px(v)}" y="${H - b + 16}" text-anchor="middle">${tell(v)}</text>`;
  for (const v of ticks(y[0], y[1], 5)) svg += `<line class="grid" x1="${l}" x2="${W - r}" y1="${py(v)}" y2="${py(v)}"/><text x="${l - 6}" y="${py(v) + 4}" text-anchor="end">${tell(v)}</text>`;
  svg += `<text x="${(l + W - r) / 2}" y="${H - 6}" text-anchor="middle">${xName}</text>`;
  svg += `<text transform="translate(14 ${(t + H - b) / 2}) rotate(-90)" text-anchor="middle">${yName}</text>`;
  return {px, py, show: inner => { $(id).innerHTML = `<svg viewBox="0 0 ${W} ${H}">${svg}${inner}</svg>`; }};
}

function drawCurve() {
  const tool = tools[state.tool], i = state.node;
  if (i < 0) return;
  const a = tool.begin[i], b = tool.begin[i + 1];
  const where = [0, 1, 2].map(j => tell(1e3 * position[3 * i + j], 4)).join(', ');
  let text = `Node ${nodeName[i]} at (${where}) mm: ${origins[tool.origin[i]]}`;
  if (a === b) {
    $('curve').innerHTML = '<p class="hint">This node has no response.</p>';
    $('said').textContent = text;
    return;
  }
  const end = tool.depth[b - 1], top = Math.max(...tool.force.subarray(a, b)) || 1;
  const p = plot('curve', [0, 1e3 * end], [0, 1.05 * top], 'depth d [mm]', 'force f [N]');
  let path = '', dots = '';
  for (let k = 0; k <= 200; ++k) {
    const d = end * k / 200;
    path += `${k ? 'L' : 'M'}${p.px(1e3 * d).toFixed(1)} ${p.py(response(tool, i, d).force).toFixed(1)}`;
  }
  for (let k = a; k < b; ++k) dots += `<circle cx="${p.px(1e3 * tool.depth[k])}" cy="${p.py(tool.force[k])}" r="2.6"/>`;
  const at = response(tool, i, state.depth), mark = p.px(1e3 * Math.min(state.depth, end));
  p.show(`<line class="mark" x1="${mark}" x2="${mark}" y1="${p.py(0)}" y2="${p.py(1.05 * top)}"/><path class="curve" d="${path}"/>${dots}`);
  text += `, estimated error ${tell(100 * tool.error[i], 2)} %. At ${tell(1e3 * state.depth)} mm: ${tell(at.force)} N, ${tell(at.force / state.depth)} N/m${at.extrapolated ? ' (beyond the last sample)' : ''}.`;
  $('said').textContent = text;
}

function drawLegend(known) {
  const kind = kinds[state.colour], counts = new Array(30).fill(0);
  if (state.colour === 'origin') {
    $('legend').innerHTML = origins.map((name, k) => `<span><i style="background:${css(originColour[k])}"></i>${name}</span>`).join(' ');
  } else {
    const bar = Array.from({length: 11}, (_, i) => css(viridis(i / 10))).join();
    $('legend').innerHTML = `<span>${tell(range[0])}</span><b style="background:linear-gradient(90deg,${bar})"></b><span>${tell(range[1])} ${kind.unit}</span> <span><i style="background:${css(originColour[0])}"></i>none</span>`;
  }
  const tool = tools[state.tool], stiff = [];
  for (let i = 0; i < n; ++i) { const v = kinds.stiffness.at(tool, i); if (Number.isFinite(v)) stiff.push(v); }
  stiff.sort((p, q) => p - q);
  if (!stiff.length) { $('histogram').innerHTML = '<p class="hint">No responses.</p>'; return; }
  const low = stiff[0], high = stiff[stiff.length - 1] > low * (1 + 1e-6) ? stiff[stiff.length - 1] : low + Math.max(1e-9, 0.1 * Math.abs(low));
  for (const v of stiff) ++counts[Math.min(29, Math.floor(30 * (v - low) / (high - low)))];
  const most = Math.max(...counts), p = plot('histogram', [low, high], [0, 1.05 * most], `stiffness f/d at ${tell(1e3 * state.depth)} mm [N/m]`, 'nodes');
  p.show(counts.map((c, k) => {
    const from = low + (high - low) * k / 30, to = low + (high - low) * (k + 1) / 30;
    const colour = state.colour === 'stiffness' ? css(viridis(place((from + to) / 2))) : '#7a8794';
    return `<rect x="${p.px(from) + 0.5}" width="${p.px(to) - p.px(from) - 1}" y="${p.py(c)}" height="${p.py(0) - p.py(c)}" fill="${colour}"><title>${tell(from)} to ${tell(to)} N/m: ${c} nodes</title></rect>`;
  }).join(''));
}
)js";

const char* const report_controls = R"js(
function choose(node) {
  state.node = node;
  drawCurve();
  redraw();
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
  state.turn[0] += dx;
  state.turn[1] = Math.min(0.1, Math.max(-Math.PI, state.turn[1] + dy));
  redraw();
}
function zoom(factor) {
  state.zoom = Math.min(20, Math.max(0.3, state.zoom * factor));
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
  if (from && from.moved <= 3) { const node = nodeAt(e.clientX, e.clientY); if (node >= 0) choose(node); }
  from = null;
});
canvas.addEventListener('wheel', e => { e.preventDefault(); zoom(Math.exp(-0.0015 * e.deltaY)); }, {passive: false});
canvas.addEventListener('keydown', e => {
  const box = canvas.getBoundingClientRect(), step = k => choose((state.node + k + n) % n);
  const act = {ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, 0.1),
    ArrowDown: () => turn(0, -0.1), '+': () => zoom(1.2), '=': () => zoom(1.2), '-': () => zoom(1 / 1.2),
    Home: () => { state.turn = [0.6, -1.1]; zoom(1 / state.zoom); }, n: () => step(1), p: () => step(state.node < 0 ? 0 : -1),
    Enter: () => { const node = nodeAt(box.left + box.width / 2, box.top + box.height / 2); if (node >= 0) choose(node); }}[e.key];
  if (act) { e.preventDefault(); act(); }
});
function setDepth(d) {
  state.depth = d;
  $('depthsaid').textContent = `${tell(1e3 * d)} mm`;
  evaluate();
}
function setTool(k) {
  state.tool = k;
  const end = tools[k].depth_max_m || 1e-3;
  for (const option of $('colour').options) option.disabled = option.value === 'verified' && !tools[k].verified.length;
  if (state.colour === 'verified' && !tools[k].verified.length) $('colour').value = state.colour = 'stiffness';
  $('depth').value = 50;
  setDepth(end / 2);
}
$('tool').innerHTML = tools.map((t, k) => `<option value="${k}"></option>`).join('');
tools.forEach((t, k) => { $('tool').options[k].textContent = `${t.name}: ${t.description}`; });
$('colour').innerHTML = Object.entries(kinds).map(([key, kind]) => `<option value="${key}">${kind.name}</option>`).join('');
$('tool').addEventListener('change', e => setTool(+e.target.value));
$('colour').addEventListener('change', e => { state.colour = e.target.value; evaluate(); });
$('depth').addEventListener('input', e => setDepth((tools[state.tool].depth_max_m || 1e-3) * e.target.value / 100));
window.addEventListener('resize', redraw);
setTool(0);
)js";

}  // namespace palpate

#include "fitting/session/batch_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fitting/numerics/robust_statistics.h"
#include "fitting/session/session_probes.h"
#include "fitting/surface/attached_point.h"
#include "formats/base/error.h"
#include "formats/report/html_page.h"
#include "formats/report/markup_escape.h"
#include "formats/report/page_text.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kMostNodes = 12000;  // of the body; more are thinned

constexpr const char* kMapStyle = R"css(
#body{display:block;width:100%;height:460px;cursor:grab;touch-action:none;background:#f4f6f8;border-radius:6px}
#map{margin:1.5em 0}#map p{color:#555}
#legend{display:flex;flex-wrap:wrap;gap:4px 14px;align-items:center;margin:.5em 0}
#legend b{flex:0 1 220px;height:12px;border-radius:3px}#legend svg{display:inline;vertical-align:-3px}
)css";

constexpr const char* kBody = R"html(
<canvas id="body" tabindex="0" role="img" aria-label="The body and the places that were measured. Arrow keys turn it, plus and minus zoom, n and p choose places."></canvas>
<div id="legend"></div>
<p>Drag turns, the wheel zooms, a click on a mark names its runs. Keys: arrows, + -, n p (next and previous place), Home. Colour: stiffness of the line through the samples in contact, the median of the place's runs that are not skipped.</p>
<div id="said" aria-live="polite"></div>
)html";

// After turnable_script.
constexpr const char* kScript = R"js(
const points = info.points, edges = {use: '#111', check: '#e69f00', skip: '#c00'};
const known = points.map(p => p.stiffness_n_per_m).filter(k => k !== null).sort((a, b) => a - b);
const pick = q => known.length ? known[Math.round(q * (known.length - 1))] : q;
let [low, high] = [pick(0.05), pick(0.95)];  // a wild one does not spoil the colours
const missing = Math.max(0.1 * Math.abs(high), 1e-9) - (high - low);  // noise is no colour
if (missing > 0) { low -= missing / 2; high += missing / 2; }
const colour = p => p.stiffness_n_per_m === null ? '#fff' : css(viridis((p.stiffness_n_per_m - low) / (high - low)));
const grey = [206, 206, 206], colourOf = () => grey;
let chosen = -1, seen = [];
function drawMarks(scale, deep) {
  const places = points.map((p, i) => [...pixelOf(p.position_m), i]).sort((a, b) => a[2] - b[2]);
  seen = [];
  for (const [x, y, z, i] of places) {
    if (!(x >= 0 && y >= 0 && x < width && y < height)) continue;
    if (z < deep[Math.floor(y) * width + Math.floor(x)] - 0.03 * radius) continue;  // behind the body
    seen.push([x / width, y / height, i]);
    const r = (i === chosen ? 9 : 6) * scale, p = points[i];
    context.beginPath();
    context.arc(x, y, r, 0, 7);
    context.fillStyle = colour(p);
    context.fill();
    context.lineWidth = (p.verdict === 'use' ? 1.2 : 2.6) * scale;
    context.strokeStyle = edges[p.verdict];
    if (p.verdict === 'skip') {
      const d = 0.7 * r;
      context.moveTo(x - d, y - d); context.lineTo(x + d, y + d);
      context.moveTo(x - d, y + d); context.lineTo(x + d, y - d);
    }
    context.stroke();
  }
}
function choose(i) {
  chosen = i;
  $('said').replaceChildren(...points[i].runs.map(run => {
    const line = document.createElement('p'), link = document.createElement('a');
    link.href = `#run${run.index}`;
    link.textContent = run.name;
    line.append(link, `: ${run.verdict}, ${run.stiffness_n_per_m === null ? 'not fitted' : tell(run.stiffness_n_per_m) + ' N/m'}`);
    return line;
  }));
  redraw();
}
function clicked(x, y) {
  const box = canvas.getBoundingClientRect();
  let best = 14, found = -1;
  for (const [u, v, i] of seen) {
    const far = Math.hypot(u * box.width - (x - box.left), v * box.height - (y - box.top));
    if (far <= best) { best = far; found = i; }
  }
  if (found >= 0) choose(found);
}
const keys = {n: () => choose((chosen + 1) % points.length),
  p: () => choose((Math.max(chosen, 0) + points.length - 1) % points.length)};
const mark = (verdict, count) => `<span><svg width="16" height="16"><circle cx="8" cy="8" r="6" fill="#eee" stroke="${edges[verdict]}" stroke-width="${verdict === 'use' ? 1.2 : 2.6}"/>${verdict === 'skip' ? '<path d="M4 4l8 8M4 12l8 -8" stroke="#c00" stroke-width="2"/>' : ''}</svg> ${verdict}: ${count}</span>`;
$('legend').innerHTML = (known.length ? `<span>${tell(low)}</span><b style="background:linear-gradient(90deg,${info.colours.join()})"></b><span>${tell(high)} N/m</span>` : '') + ['use', 'check', 'skip'].map(v => mark(v, points.filter(p => p.verdict === v).length)).join(' ');
redraw();
)js";

// One run that has a place.
struct Visit {
  std::size_t index = 0;  // among the report's
  const RunResult* run = nullptr;
};

using Place = std::array<double, 3>;

Json stiffness_json(const RunResult& run) {
  return run.best() == nullptr ? Json() : Json(run.contact.mean_stiffness_n_per_m);
}

Json place_json(const Eigen::Vector3d& position_m, const std::vector<Visit>& visits) {
  std::vector<double> stiffness;
  Verdict best = Verdict::kSkip;
  Json runs = Json::array();
  for (const auto& [index, run] : visits) {
    const Verdict verdict = run->rating.verdict;
    if (run->best() != nullptr && verdict != Verdict::kSkip) {
      stiffness.push_back(run->contact.mean_stiffness_n_per_m);
    }
    if (verdict == Verdict::kUse || best == Verdict::kSkip) {
      best = verdict;
    }
    runs.push_back({{"index", index},
                    {"name", run->name},
                    {"verdict", verdict_name(verdict)},
                    {"stiffness_n_per_m", stiffness_json(*run)}});
  }
  return {{"position_m", {position_m.x(), position_m.y(), position_m.z()}},
          {"verdict", verdict_name(best)},
          {"stiffness_n_per_m", stiffness.empty() ? Json() : Json(median(stiffness))},
          {"runs", runs}};
}

Json places_json(const SurfaceMesh& body,
                 const std::map<Place, std::vector<Visit>>& places) {
  Json list = Json::array();
  for (const auto& [place, visits] : places) {
    const AttachedPoint at =
        closest_surface_point(body, Eigen::Vector3d(place[0], place[1], place[2]));
    list.push_back(place_json(position_m(body, at), visits));
  }
  return list;
}

std::string section(const SurfaceMesh& body,
                    const std::map<Place, std::vector<Visit>>& places) {
  const Json info{{"box", page_box(body)}, {"points", places_json(body, places)}};
  return fmt::format(
      "<section id=\"map\"><style>{}</style><h2>Measured places</h2>{}</section>\n{}{}"
      "{}",
      kMapStyle, kBody, page_info(info),
      page_body(body, vertex_normals(body), thin_body(body, kMostNodes)),
      page_script({figures_script, turnable_script, kScript}));
}

}  // namespace

std::string batch_map(const Session& session, const BatchReport& report) {
  std::map<Place, std::vector<Visit>> places;
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    if (const auto& p = report.runs[i].position_m) {
      places[{p->x(), p->y(), p->z()}].push_back({i, &report.runs[i]});
    }
  }
  if (session.mesh.empty() || places.empty()) {
    return "";
  }
  try {
    return section(session_body(session), places);
  } catch (const Error& error) {
    return fmt::format("<p>No map of the body: {}</p>\n", markup_escaped(error.what()));
  }
}

}  // namespace palpate

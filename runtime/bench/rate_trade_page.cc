#include "runtime/bench/rate_trade_page.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/report/html_page.h"
#include "formats/report/page_text.h"

namespace palpate {
namespace {

constexpr const char* kStyle = R"css(
main { grid-template-columns: minmax(0, 1fr); }
#key span { margin-right: 16px; white-space: nowrap; }
#key svg { display: inline; width: 34px; height: 10px; margin-right: 6px; }
svg .line { fill: none; stroke-width: 2; }
svg .line + circle, svg circle { fill: currentColor; }
td { font-variant-numeric: tabular-nums; }
)css";

constexpr const char* kBody = R"html(<main><section>
<div class="controls">
<label for="what">Shown</label><select id="what"></select>
<label for="device">Device</label><select id="device"></select>
<label for="wall">Wall</label><select id="wall"></select>
<label for="fast_hz">Fast rate [Hz]</label><select id="fast_hz"></select>
</div></section>
<section><div id="plot"></div><div id="key" class="hint"></div></section>
<section><table id="table"></table></section></main>
)html";

// After figures_script.
constexpr const char* kScript = R"js(
const $ = id => document.getElementById(id);
const { rows } = JSON.parse($('info').textContent);
const kinds = {
  stiffness: {name: 'largest stable stiffness [N/m]', at: r => r.stable_stiffness_n_per_m, log: true},
  error: {name: 'force error of pokes, rms [%]', at: r => 100 * r.rms_relative_error},
  energy: {name: 'net energy of pokes [mJ]', at: r => 1e3 * r.net_energy_j},
  cpu: {name: 'processor time [%]', at: r => 100 * r.cpu_s_per_s},
};
// Told apart without colour, too: two models may lie on each other.
const looks = [['#0072b2', ''], ['#e69f00', '8 4'], ['#009e73', '2 3'], ['#d55e00', '12 3 2 3'], ['#cc79a7', '5 5'], ['#56b4e9', '1 5']];
const models = [...new Set(rows.map(r => r.model))];
const cell = (kind, text) => Object.assign(document.createElement(kind), {textContent: text});

function fill(id, values, name = v => v) {
  $(id).replaceChildren(...values.map(v => Object.assign(cell('option', name(v)), {value: v})));
  $(id).addEventListener('change', show);
}
function line(plot, points, k) {
  const [stroke, dashes] = looks[k % looks.length];
  plot.add('path', {class: 'line', stroke, 'stroke-dasharray': dashes, d: plot.path(points)});
}
function show() {
  const kind = kinds[$('what').value];
  const chosen = rows.filter(r => ['device', 'wall', 'fast_hz'].every(key => String(r[key]) === $(key).value));
  const slow = [...new Set(chosen.map(r => r.slow_hz))].sort((a, b) => a - b);
  const fits = v => Number.isFinite(v) && (!kind.log || v > 0), values = chosen.map(kind.at).filter(fits);
  const most = Math.max(...values), least = Math.min(...values);
  const plot = new Plot($('plot'), {width: 900, height: 420, xLog: true, yLog: kind.log,
    x: slow.length > 1 ? [slow[0], slow.at(-1)] : [slow[0] / 2, 2 * slow[0]],
    y: kind.log ? [least / 1.2, 1.2 * most] : [Math.min(0, 1.05 * least), Math.max(0, 1.05 * most) || (least < 0 ? 0 : 1)],
    xName: 'slow rate [Hz]', yName: kind.name});
  models.forEach((model, k) => {
    const points = slow.flatMap(hz => chosen.filter(r => r.model === model && r.slow_hz === hz).map(r => [hz, kind.at(r)])).filter(([, v]) => fits(v));
    line(plot, points, k);
    points.forEach(([x, y]) => {
      const dot = plot.add('circle', {cx: plot.px(x), cy: plot.py(y), r: 3.5, color: looks[k % looks.length][0]});
      dot.append(document.createElementNS(dot.namespaceURI, 'title'));
      dot.firstChild.textContent = `${model}, ${x} Hz: ${tell(y)}`;
    });
  });
  const head = document.createElement('tr');
  head.append(cell('th', 'slow rate [Hz]'), ...models.map(m => cell('th', m)));
  $('table').replaceChildren(head, ...slow.map(hz => {
    const row = document.createElement('tr');
    row.append(cell('th', hz), ...models.map(m => cell('td', tell(chosen.filter(r => r.model === m && r.slow_hz === hz).map(kind.at)[0]))));
    return row;
  }));
}
$('key').append(...models.map((model, k) => {
  const name = cell('span', model), [stroke, dashes] = looks[k % looks.length];
  name.insertAdjacentHTML('afterbegin', `<svg viewBox="0 0 34 10"><path class="line" d="M0 5H34" stroke="${stroke}" stroke-dasharray="${dashes}"/></svg>`);
  return name;
}));
fill('what', Object.keys(kinds), key => kinds[key].name);
for (const key of ['device', 'wall', 'fast_hz']) fill(key, [...new Set(rows.map(r => r[key]))]);
show();
)js";

}  // namespace

std::string trade_page(const std::vector<RateTradeRow>& rows) {
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
             "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src "
             "'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'\">\n"
             "<title>Stiffness, error, energy and processor time by rates</title>\n"
             "<style>{}{}</style></head><body>\n<h1>What rates and local model "
             "buy</h1>\n<p class=\"sub\">{} runs of palpate-run bench trade</p>\n",
             report_style, kStyle, rows.size()) +
         kBody + page_info(parse_ordered_json(to_json(rows))) +
         page_script({figures_script, kScript}) + "</body></html>\n";
}

}  // namespace palpate

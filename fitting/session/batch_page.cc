// The batch as one page: a table and plots, drawn here without a script, and the map.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "fitting/session/batch.h"
#include "fitting/session/batch_map.h"
#include "fitting/session/batch_summary.h"
#include "fitting/session/corrections_report.h"
#include "formats/report/axis_ticks.h"
#include "formats/report/markup_escape.h"

namespace palpate {
namespace {

constexpr const char* kStyle =
    "body{font:14px/1.4 system-ui,sans-serif;margin:2em auto;max-width:1100px;"
    "color:#222;padding:0 1em}"
    "table{border-collapse:collapse;width:100%;font-size:13px}"
    "th,td{text-align:left;padding:2px 8px;border-bottom:1px solid #ddd}"
    "td.n{text-align:right;font-variant-numeric:tabular-nums}"
    ".use{color:#17692b}.check{color:#8a5a00}.skip{color:#a01818}"
    "article{margin:2em 0;break-inside:avoid}svg{display:block;max-width:100%}"
    "h2{font-size:16px;margin:0}p{margin:.3em 0}";
constexpr double kWidth = 720.0, kLeft = 70.0, kRight = 12.0;
constexpr std::size_t kDots = 400;  // samples drawn per plot
constexpr int kDrawnPoints = 160;   // of a drawn curve

// A plot's frame: from values to places on the page.
struct Frame {
  double x_low, x_high, y_low, y_high, top, height;

  [[nodiscard]] double x(double value) const {
    return kLeft + (kWidth - kLeft - kRight) * (value - x_low) / (x_high - x_low);
  }
  [[nodiscard]] double y(double value) const {
    return top + height * (y_high - value) / (y_high - y_low);
  }
};

std::string axes(const Frame& frame, const std::string& label) {
  std::string svg = fmt::format(
      "<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#999\"/><text transform=\"translate(14 {:.1f}) rotate(-90)\" "
      "font-size=\"12\" text-anchor=\"middle\">{}</text>",
      kLeft, frame.top, kWidth - kLeft - kRight, frame.height,
      frame.top + 0.5 * frame.height, label);
  for (const double tick : axis_ticks(frame.y_low, frame.y_high, 4)) {
    svg += fmt::format(
        "<path d=\"M{} {:.1f}h-4\" stroke=\"#999\"/><text x=\"{}\" y=\"{:.1f}\" "
        "font-size=\"11\" text-anchor=\"end\">{}</text>",
        kLeft, frame.y(tick), kLeft - 6, frame.y(tick) + 4, short_number(tick));
  }
  return svg;
}

std::string x_ticks(const Frame& frame) {
  std::string svg;
  const double base = frame.top + frame.height;
  for (const double tick : axis_ticks(frame.x_low, frame.x_high, 8)) {
    svg += fmt::format(
        "<path d=\"M{:.1f} {:.1f}v4\" stroke=\"#999\"/><text x=\"{:.1f}\" "
        "y=\"{:.1f}\" font-size=\"11\" text-anchor=\"middle\">{}</text>",
        frame.x(tick), base, frame.x(tick), base + 16, short_number(tick));
  }
  return svg;
}

std::string dots(const Frame& frame, const std::vector<double>& x,
                 const std::vector<double>& y) {
  std::string path;
  const std::size_t step = std::max<std::size_t>(1, x.size() / kDots);
  for (std::size_t i = 0; i < x.size(); i += step) {
    path += fmt::format("M{:.1f} {:.1f}h0", frame.x(x[i]), frame.y(y[i]));
  }
  return "<path d=\"" + path +
         "\" stroke=\"#555\" stroke-width=\"3\" stroke-linecap=\"round\" "
         "fill=\"none\"/>";
}

std::pair<double, double> padded_extent(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double pad = 0.05 * (*high - *low) + 1e-12;
  return {*low - pad, *high + pad};
}

// The largest unit prefix that keeps the force above 1, and its size.
std::pair<double, const char*> force_unit(double largest_n) {
  if (largest_n >= 0.1) {
    return {1.0, "N"};
  }
  if (largest_n >= 1e-4) {
    return {1e3, "mN"};
  }
  return largest_n >= 1e-7 ? std::pair{1e6, "uN"} : std::pair{1e9, "nN"};
}

std::string curve_and_band(const Frame& frame, const FamilyFit& fit, double force_size,
                           double length_size) {
  std::string line, above, below;
  for (int i = 0; i <= kDrawnPoints; ++i) {
    const double x = frame.x_low + (frame.x_high - frame.x_low) * i / kDrawnPoints;
    const double f = fitted_force_n(fit, x / length_size);
    const double sd = fitted_sd_n(fit, x / length_size);
    const double half = std::isfinite(sd) ? 1.96 * sd : 0.0;
    line += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", frame.x(x),
                        frame.y(force_size * f));
    above += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", frame.x(x),
                         frame.y(force_size * (f + half)));
    below =
        fmt::format("L{:.1f} {:.1f}", frame.x(x), frame.y(force_size * (f - half))) +
        below;
  }
  return fmt::format(
      "<path d=\"{}{}Z\" fill=\"#2a6fdb\" fill-opacity=\".25\"/><path d=\"{}\" "
      "stroke=\"#2a6fdb\" stroke-width=\"1.5\" fill=\"none\"/>",
      above, below, line);
}

std::string plot(const RunResult& run) {
  const FamilyFit& fit = *run.best();
  const auto& depth = run.choice.displacement_m;
  const auto [force_size, unit] = force_unit(fit.force_n);
  const bool small = fit.length_m < 1e-4;
  const double length_size = small ? 1e6 : 1e3;
  std::vector<double> x, f, residual;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    x.push_back(length_size * depth[i]);
    f.push_back(force_size * run.choice.force_n[i]);
    residual.push_back(force_size *
                       (run.choice.force_n[i] - fitted_force_n(fit, depth[i])));
  }
  const auto [x_low, x_high] = padded_extent(x);
  const auto [f_low, f_high] = padded_extent(f);
  const auto [r_low, r_high] = padded_extent(residual);
  const Frame main{x_low, x_high, f_low, f_high, 8, 240};
  const Frame rest{x_low, x_high, r_low, r_high, 262, 90};
  const double contact = main.x(length_size * fit.contact_point_m);
  return fmt::format(
             "<svg viewBox=\"0 0 {} 390\" width=\"{}\" role=\"img\">"
             "<clipPath id=\"c\"><rect x=\"{}\" y=\"8\" width=\"{}\" height=\"240\"/>"
             "</clipPath>",
             kWidth, kWidth, kLeft, kWidth - kLeft - kRight) +
         axes(main, fmt::format("force [{}]", unit)) + dots(main, x, f) +
         "<g clip-path=\"url(#c)\">" +
         curve_and_band(main, fit, force_size, length_size) +
         fmt::format(
             "<path d=\"M{:.1f} 8V248\" stroke=\"#c33\" "
             "stroke-dasharray=\"4 3\"/></g>",
             contact) +
         axes(rest, "residual") + dots(rest, x, residual) + x_ticks(rest) +
         fmt::format(
             "<text x=\"{}\" y=\"386\" font-size=\"12\" "
             "text-anchor=\"middle\">displacement [{}]</text></svg>\n",
             kWidth / 2, small ? "um" : "mm");
}

std::string run_row(const RunResult& run) {
  const char* verdict = verdict_name(run.rating.verdict).data();
  std::string row =
      fmt::format("<tr><td>{}</td><td class=\"{}\">{}</td><td class=\"n\">{:.2f}</td>",
                  markup_escaped(run.name), verdict, verdict, run.rating.score);
  const FamilyFit* best = run.best();
  if (best == nullptr) {
    return row + "<td colspan=\"4\">" +
           markup_escaped(run.bad.empty() ? "empty run" : run.bad) + "</td></tr>\n";
  }
  const std::string modulus =
      run.modulus.refused.empty()
          ? fmt::format("{:.4g} &plusmn; {:.2g} kPa",
                        1e-3 * run.modulus.youngs_modulus_pa, 1e-3 * run.modulus.sd_pa)
          : "none";
  const double contact_mm = 1e3 * best->contact_point_m;
  const double sd_mm = 1e3 * best->contact_point_sd_m;
  const std::string contact =
      std::isfinite(sd_mm) ? fmt::format("{:.5g} &plusmn; {:.2g}", contact_mm, sd_mm)
                           : fmt::format("{:.3f}, assumed", contact_mm);
  return row + fmt::format(
                   "<td class=\"n\">{}</td><td>{}</td>"
                   "<td class=\"n\">{:.3g}</td><td>{}</td></tr>\n",
                   contact, best->family, best->rms_n, modulus);
}

std::string article(const RunResult& run, const Indenter& indenter, std::size_t index) {
  const FamilyFit& best = *run.best();
  std::string html =
      fmt::format("<article id=\"run{}\"><h2>{}</h2><p>{}, chosen before ", index,
                  markup_escaped(run.name), best.family);
  for (std::size_t i = 1; i < run.choice.fits.size(); ++i) {
    const FamilyFit& other = run.choice.fits[i];
    html += fmt::format("{}{} (rms {:.3g} N)", i == 1 ? "" : ", ", other.family,
                        other.rms_n);
  }
  html += run.choice.fits.size() == 1 ? "none</p>" : "</p>";
  for (const FitFlag flag : run.flags) {
    html += fmt::format("<p><b>{}</b>: {}</p>", flag_name(flag),
                        markup_escaped(std::string(flag_meaning(flag))));
  }
  if (const std::string text = corrections_text(run.corrections, indenter);
      !text.empty()) {
    html += "<p>" + markup_escaped(text) + "</p>";
  }
  if (!run.modulus.refused.empty()) {
    html += "<p>No modulus: " + markup_escaped(run.modulus.refused) + "</p>";
  }
  if (run.relaxation.refused.empty()) {
    const Relaxation& r = run.relaxation;
    html += fmt::format(
        "<p>Relaxation over {:.3g} s: {:.3g} stays; {:.3g} in {:.3g} s, {:.3g} in "
        "{:.3g} s; rms {:.2g} %</p>",
        r.seconds, r.g_inf, r.g[0], r.tau_s[0], r.g[1], r.tau_s[1],
        100.0 * r.rms_relative);
    html += "<p>" + markup_escaped(describe(r.joint)) + "</p>";
  }
  return html + plot(run) + "</article>\n";
}

}  // namespace

std::string batch_page(const Session& session, const BatchReport& report,
                       std::size_t most) {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "script-src 'unsafe-inline'; style-src 'unsafe-inline'\"><title>{0}: "
      "fits</title><style>{1}</style></head>"
      "<body><h1>{0}</h1>\n<p>{2} runs. Bands are 95 % of the fitted curve, from the "
      "parameters alone; the dashed line is the contact point.</p>\n<table><tr><th>run"
      "</th><th>verdict</th><th>score</th><th>contact point [mm]</th><th>family</th>"
      "<th>rms [N]</th><th>Young's modulus</th></tr>\n",
      markup_escaped(session.name), kStyle, report.runs.size());
  for (const RunResult& run : report.runs) {
    page += run_row(run);
  }
  page += "</table>\n" + batch_summary(session, report) + batch_map(session, report);
  std::size_t drawn = 0, fitted = 0;
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    if (report.runs[i].best() != nullptr) {
      page += drawn < most ? article(report.runs[i], session.indenter, i) : "";
      drawn += drawn < most ? 1 : 0;
      ++fitted;
    }
  }
  if (drawn < fitted) {
    page +=
        fmt::format("<p>Plots of the first {} of {} fitted runs.</p>\n", drawn, fitted);
  }
  return page + "</body></html>\n";
}

}  // namespace palpate

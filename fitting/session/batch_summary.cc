#include "fitting/session/batch_summary.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fitting/session/mean_curves.h"
#include "fitting/session/session_machine.h"
#include "formats/report/markup_escape.h"

namespace palpate {
namespace {

// An empty cell where the number is not known.
std::string number_cell(double value, int digits = 4) {
  return std::isfinite(value)
             ? fmt::format("<td class=\"n\">{:.{}g}</td>", value, digits)
             : "<td></td>";
}

std::string machine(const Session& session, const BatchReport& report) {
  std::string html;
  if (report.frame) {
    html += fmt::format("<p>Frame: {}; its deflection is taken off.</p>\n",
                        describe_frame(report.frame));
  }
  if (session.registration) {
    std::string lines = markup_escaped(describe_registration(session));
    for (std::size_t at = 0; (at = lines.find('\n', at)) != std::string::npos;) {
      lines.replace(at, 1, "<br>");
    }
    html += "<p>Registration to the mesh: " + lines + "</p>\n";
  }
  return html;
}

std::string cycle_row(const std::string& run, std::size_t press,
                      const CycleSummary& c) {
  return fmt::format("<tr><td>{}</td><td class=\"n\">{}</td>", markup_escaped(run),
                     press) +
         (c.bad.empty() ? number_cell(c.peak_force_n) + number_cell(c.press_work_j) +
                              number_cell(c.loss_j) + number_cell(c.loss_factor, 3) +
                              number_cell(1e3 * c.contact_point_m, 5) +
                              number_cell(1e3 * c.contact_point_sd_m, 2) +
                              number_cell(1e3 * c.contact_shift_m, 3) +
                              number_cell(1e3 * c.contact_shift_sd_m, 2)
                        : "<td colspan=\"8\">" + markup_escaped(c.bad) + "</td>") +
         "</tr>\n";
}

std::string cycles(const BatchReport& report) {
  std::string rows;
  for (const RunResult& run : report.runs) {
    for (std::size_t k = 0; k < run.cycles.size(); ++k) {
      rows += cycle_row(run.run_name, k + 1, run.cycles[k]);
    }
  }
  return rows.empty()
             ? ""
             : "<h2>Cycles</h2><p>Each press of the files with several; the shift is "
               "that of the contact point against the last press.</p><table><tr>"
               "<th>run</th><th>press</th><th>peak force [N]</th><th>work [J]</th>"
               "<th>loss [J]</th><th>loss factor</th><th>contact point [mm]</th>"
               "<th>&plusmn;</th><th>shift [mm]</th><th>&plusmn;</th></tr>\n" +
                   rows + "</table>\n";
}

std::string means(const BatchReport& report) {
  std::string rows;
  const MeanCurves all = mean_curves(report);
  for (const MeanCurve& mean : all.curves) {
    if (mean.depth_m.empty()) {
      continue;
    }
    const RandomEffects& e = mean.force_n.back();
    rows += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td>",
                        markup_escaped(mean.name), mean.runs) +
            number_cell(1e3 * mean.depth_m.back()) + number_cell(e.mean) +
            number_cell(e.lower) + number_cell(e.upper) + number_cell(e.repeat_sd, 3) +
            number_cell(e.point_sd, 3) + number_cell(e.specimen_sd, 3) + "</tr>\n";
  }
  return rows.empty()
             ? ""
             : "<h2>Means</h2><p>At the largest depth that all of their runs reach; "
               "standard deviations within points, between points of one specimen and "
               "between specimens; the interval is Student's t. All depths: "
               "mean_curves.csv of palpate-fit batch. " +
                   left_out_text(all) +
                   "</p><table><tr><th>mean of</th>"
                   "<th>runs</th><th>depth [mm]</th><th>force [N]</th><th>95 % "
                   "from</th>"
                   "<th>to</th><th>repeats [N]</th><th>points [N]</th><th>specimens "
                   "[N]</th>"
                   "</tr>\n" +
                   rows + "</table>\n";
}

}  // namespace

std::string batch_summary(const Session& session, const BatchReport& report) {
  return machine(session, report) + cycles(report) + means(report);
}

}  // namespace palpate

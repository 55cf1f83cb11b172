#include "formats/report/database_page.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/quantile.h"
#include "formats/database/database_summary.h"
#include "formats/report/display_mesh.h"
#include "formats/report/html_page.h"
#include "formats/report/markup_escape.h"
#include "formats/report/page_text.h"

namespace palpate {
namespace {

std::vector<float> singles(const std::vector<double>& all,
                           const std::vector<std::int32_t>& nodes) {
  std::vector<float> values;
  for (const std::int32_t node : all.empty() ? std::vector<std::int32_t>() : nodes) {
    values.push_back(static_cast<float>(all[static_cast<std::size_t>(node)]));
  }
  return values;
}

// g_1 .. g_K of each node; none where responses are static.
std::vector<float> share_rows(const Viscoelasticity& relaxation,
                              const std::vector<std::int32_t>& nodes) {
  std::vector<float> rows;
  for (const std::int32_t node :
       relaxation.empty() ? std::vector<std::int32_t>() : nodes) {
    for (const double g : relaxation.shares(node)) {
      rows.push_back(static_cast<float>(g));
    }
  }
  return rows;
}

std::string table_arrays(const ResponseTable& table, std::size_t tool,
                         const std::vector<std::int32_t>& nodes) {
  std::vector<std::int32_t> begin{0};
  std::vector<float> depth_m;
  std::vector<float> force_n;
  std::vector<float> slope_n_per_m;
  std::vector<std::uint8_t> origin;
  const auto append = [](std::vector<float>& to, std::span<const double> from) {
    for (const double value : from) {
      to.push_back(static_cast<float>(value));
    }
  };
  for (const std::int32_t node : nodes) {
    const CurveView curve = table.curve(node);
    append(depth_m, curve.depth_m);
    append(force_n, curve.force_n);
    append(slope_n_per_m, curve.stiffness_n_per_m);
    begin.push_back(static_cast<std::int32_t>(depth_m.size()));
    origin.push_back(table.origin[static_cast<std::size_t>(node)]);
  }
  const auto id = [&](const char* name) {
    return fmt::format("{}{}", name, tool);
  };
  return page_array(id("begin"), begin) + page_array(id("depth"), depth_m) +
         page_array(id("force"), force_n) + page_array(id("slope"), slope_n_per_m) +
         page_array(id("slopemax"), singles(table.stiffness_max_n_per_m, nodes)) +
         page_array(id("error"), singles(table.error_relative, nodes)) +
         page_array(id("verified"), singles(table.verified_error_relative, nodes)) +
         page_array(id("origin"), origin) +
         page_array(id("g"), share_rows(table.viscoelasticity, nodes));
}

std::string info(const ResponseDatabase& database) {
  nlohmann::ordered_json tools = nlohmann::ordered_json::array();
  for (const ResponseTable& table : database.tools) {
    tools.push_back({{"name", table.tool.name},
                     {"description", describe_tool(table.tool, table.puncture)},
                     {"depth_max_m", table.depth_max_m()},
                     {"tau_s", table.viscoelasticity.tau_s}});
  }
  return page_info({{"tools", tools}, {"box", page_box(database.body)}});
}

std::string row(const std::string& name, const std::string& value) {
  return value.empty() ? ""
                       : fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", name,
                                     markup_escaped(value));
}

// The error that this share of the responses does not exceed.
double error_quantile(const ResponseTable& table, double share) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < table.origin.size(); ++i) {
    if (table.origin[i] != 0) {
      errors.push_back(table.error_relative[i]);
    }
  }
  std::sort(errors.begin(), errors.end());
  return quantile(errors, share);
}

std::string accuracy_of(const ResponseTable& table) {
  std::string text = fmt::format(
      "stated error of force {:.2g} % median, {:.2g} % at the 95th percentile, "
      "{:.2g} "
      "% largest",
      100.0 * error_quantile(table, 0.5), 100.0 * error_quantile(table, 0.95),
      100.0 * error_quantile(table, 1.0));
  const AccuracyRecord& accuracy = table.accuracy;
  if (accuracy.budget_relative > 0.0) {
    text += fmt::format("; budget {:.3g} %", 100.0 * accuracy.budget_relative);
  }
  if (const std::string errors = describe(accuracy); !errors.empty()) {
    text += "; these " + errors;
  }
  return text;
}

// How often which: "3 of touches late: mesh 2 times finer", a line each.
std::string histories(const ResponseTable& table) {
  std::string text;
  for (std::size_t k = 0; k < table.history_text.size(); ++k) {
    const auto count = std::count(table.history.begin(), table.history.end(),
                                  static_cast<std::int32_t>(k));
    if (count > 0) {
      text += fmt::format("{}{} of {}", text.empty() ? "" : "<br>", count,
                          markup_escaped(table.history_text[k]));
    }
  }
  return text;
}

std::string tool_rows(const ResponseTable& table) {
  const ToolSummary all = summarise(table);
  std::string text =
      row(table.tool.name.empty() ? "tool" : markup_escaped(table.tool.name),
          fmt::format("{}, friction {:.3g}, presliding {:.3g} mm",
                      describe_tool(table.tool, table.puncture), table.tool.friction,
                      1e3 * table.tool.presliding_m));
  text += row("responses", fmt::format("{}: {} simulated, {} interpolated, {} measured",
                                       all.responses, all.simulated, all.interpolated,
                                       all.measured));
  text +=
      row("largest", fmt::format("depth {:.4g} mm, force {:.4g} N, slope {:.4g} N/m",
                                 1e3 * all.depth_max_m, all.force_max_n,
                                 all.stiffness_max_n_per_m));
  text += row("flags",
              fmt::format("{} falling, {} force capped, {} coarse contact, {} over "
                          "the error budget, {} failed, {} extrapolated, {} "
                          "truncated, {} with a path that was hard to follow",
                          all.falling, all.force_capped, all.coarse_contact,
                          all.error_over_budget, all.failed, all.extrapolated,
                          all.truncated_path, all.near_singular));
  if (const std::string again = histories(table); !again.empty()) {
    text += row("solved again", again);
  }
  if (!table.relaxation.empty()) {
    text += row("relaxation", describe(table.relaxation) + "; not rendered");
  }
  if (!table.viscoelasticity.empty()) {
    text += row("relaxation", describe(all.viscoelasticity, all.shares));
  }
  if (!all.yielding.empty()) {
    text += row("yielding", all.yielding);
  }
  if (table.viscoelasticity.remembers()) {
    text += row("memory", describe_memory(all));
  }
  if (!all.compliance.empty()) {
    text += row("coupling", describe(all.compliance));
  }
  if (!all.puncture.empty()) {
    text += row("puncture", describe_puncture(all));
  }
  return text + row("accuracy", accuracy_of(table));
}

std::string tables(const ResponseDatabase& database) {
  std::string tools;
  for (const ResponseTable& table : database.tools) {
    tools += tool_rows(table);
  }
  const Provenance& from = database.provenance;
  const std::string measured =
      database.measurement.depth_m.empty()
          ? ""
          : fmt::format("{} samples", database.measurement.depth_m.size());
  std::string text =
      "<section class=\"wide\"><h2>Tools and accuracy</h2><table>\n" + tools +
      "</table></section>\n<section class=\"wide\"><h2>Provenance</h2><table>\n" +
      row("written by", from.writer) + row("source", from.source_file) +
      row("its SHA-256", from.source_sha256) + row("measured", measured) +
      row("left out", from.left_out) +
      row("storage", fmt::format("{}{}", name_of(database.storage.precision),
                                 database.storage.compress ? ", compressed" : ""));
  text += "</table>";
  if (!from.scene_toml.empty()) {
    text += "<details><summary>The scene as it was read</summary><pre>" +
            markup_escaped(from.scene_toml) + "</pre></details>";
  }
  return text + "</section>\n";
}

std::string head(const ResponseDatabase& database, const std::string& name,
                 const ThinBody& thin) {
  const Eigen::Vector3d size_mm = 1e3 * bounding_box(database.body).sizes();
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "script-src 'unsafe-inline'; style-src 'unsafe-inline'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}: responses</title>\n<style>{1}</style></head><body>\n<h1>{0}</h1>\n"
      "<p class=\"sub\">Force-deflection responses of a body of {2} nodes and {3} "
      "triangles, {4:.4g} x {5:.4g} x {6:.4g} mm</p>\n",
      markup_escaped(name), report_style, database.body.position_m.rows(),
      database.body.triangle.rows(), size_mm.x(), size_mm.y(), size_mm.z());
  if (std::ssize(thin.node) < database.body.position_m.rows()) {
    text += fmt::format(
        "<p class=\"note\">Thinned for this page: {} of {} nodes are shown, with their "
        "own "
        "curves; colours, picture and histogram are of these. Tools and accuracy below "
        "count all.</p>\n",
        thin.node.size(), database.body.position_m.rows());
  }
  return text;
}

}  // namespace

std::string report_page(const ResponseDatabase& database, const std::string& name,
                        std::int64_t most_nodes) {
  const ThinBody thin =
      thin_body(database.body,
                std::max<std::int64_t>(1, most_nodes / std::ssize(database.tools)));
  std::string page = head(database, name, thin);
  page += std::string("<main>") + report_body + tables(database) + "</main>\n";
  page += info(database) + page_body(database.body, database.normal, thin) +
          page_array("node", thin.node);
  for (std::size_t k = 0; k < database.tools.size(); ++k) {
    page += table_arrays(database.tools[k], k, thin.node);
  }
  return page + page_script({figures_script, turnable_script, report_script}) +
         "</body></html>\n";
}

}  // namespace palpate

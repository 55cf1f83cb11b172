#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"
#include "formats/base/printable.h"
#include "formats/command/commands.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_summary.h"
#include "formats/database/response_database.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct InfoFlags {
  std::string file;
  bool json = false;
};

Json to_json(const ResponseRelaxation& relaxation) {
  if (relaxation.empty()) {
    return nullptr;
  }
  Json json{{"rule", relaxation.rule},
            {"probes", relaxation.probes},
            {"speed_m_per_s", relaxation.speed_m_per_s},
            {"seconds", relaxation.seconds}};
  const auto put = [&](const char* name, const std::vector<double>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    json[name] = {*low, *high};  // over the nodes
  };
  put("g_1", relaxation.terms.g_1);
  put("g_2", relaxation.terms.g_2);
  put("tau_1_s", relaxation.terms.tau_1_s);
  put("tau_2_s", relaxation.terms.tau_2_s);
  return json;
}

Json viscoelasticity_json(const ToolSummary& tool) {
  const Viscoelasticity& relaxation = tool.viscoelasticity;
  if (relaxation.empty()) {
    return nullptr;
  }
  Json shares = Json::array();  // of each term and of their sum, over the nodes
  for (Eigen::Index k = 0; k < tool.shares.low.size(); ++k) {
    shares.push_back({tool.shares.low(k), tool.shares.high(k)});
  }
  return {{"rule", relaxation.rule},
          {"probes", relaxation.probes},
          {"curve", relaxation.instantaneous ? "instantaneous" : "press"},
          {"speed_m_per_s", relaxation.speed_m_per_s},
          {"tau_s", relaxation.tau_s},
          {"g_and_sum", shares},
          {"sites", tool.memory_sites},
          {"spacing_m", relaxation.sites.spacing_m},
          {"spacing_in_contact_radii", spacing_in_contact_radii(tool)},
          {"bundles", relaxation.bundles()},
          {"doubts", doubts_of_memory(tool)}};
}

// By node: nulls.
Json yielding_json(const ToolSummary& tool) {
  if (tool.yielding.empty()) {
    return nullptr;
  }
  Json json{{"text", tool.yielding}, {"sites", tool.memory_sites}};
  for_each_dataset(
      tool.viscoelasticity.yielding, [&](const std::string& name, const char* /*units*/,
                                         const std::vector<double>& values) {
        json[name.substr(1)] = values.size() == 1 ? Json(values[0]) : Json(nullptr);
      });
  return json;
}

Json contacts_json(const ToolShape& tool) {
  Json spheres = Json::array();
  for (std::size_t i = 0; i < tool.contact.radius_m.size(); ++i) {
    const auto at = tool.contact.point_m.row(static_cast<Eigen::Index>(i));
    spheres.push_back({{"point_m", {at.x(), at.y(), at.z()}},
                       {"radius_m", tool.contact.radius_m[i]}});
  }
  return spheres;
}

Json compliance_json(const ComplianceTable& table) {
  if (table.empty()) {
    return nullptr;
  }
  return {{"text", describe(table)},
          {"distance_m", table.distance_m},
          {"modes", table.modes()},
          {"error_relative", table.error_relative},
          {"convex", table.convex}};
}

// Infinite forces and unknown toughness: nulls.
Json puncture_json(const ToolSummary& tool) {
  const Puncture& puncture = tool.puncture;
  if (puncture.empty()) {
    return nullptr;
  }
  Json materials = Json::array();
  for (std::size_t m = 0; m < puncture.material.size(); ++m) {
    materials.push_back({{"name", puncture.material[m]},
                         {"membrane_n", puncture.membrane_n[m]},
                         {"membrane_j", membrane_j_of(puncture, m)},
                         {"cutting_n", puncture.cutting_n[m]},
                         {"friction_n_per_m", puncture.friction_n_per_m[m]},
                         {"static_ratio", puncture.static_ratio[m]},
                         {"toughness_j_per_m2", puncture.toughness_j_per_m2[m]}});
  }
  const auto [low, high] = std::ranges::minmax(puncture.rupture);
  Json json{{"text", describe(puncture)},
            {"doubts", doubts_of_puncture(tool)},
            {"rule", puncture.rule},
            {"rupture", {low, high}},
            {"rupture_units", rupture_units(puncture)},
            {"materials", materials}};
  const auto add = [&json](const char* name, double number) {
    json[name] = number;
  };
  for_each_puncture_number(puncture, add);
  for_each_optional_puncture_number(puncture, add);
  return json;
}

Json to_json(const ToolSummary& tool) {
  return {{"name", tool.tool.name},
          {"shape", tool.tool.kind},
          {"radius_m", tool.tool.radius_m},
          {"description", describe_tool(tool.tool, tool.puncture)},
          {"friction", tool.tool.friction},
          {"presliding_m", tool.tool.presliding_m},
          {"responses", tool.responses},
          {"simulated", tool.simulated},
          {"interpolated", tool.interpolated},
          {"measured", tool.measured},
          {"falling", tool.falling},
          {"force_capped", tool.force_capped},
          {"coarse_contact", tool.coarse_contact},
          {"error_over_budget", tool.error_over_budget},
          {"failed", tool.failed},
          {"extrapolated", tool.extrapolated},
          {"truncated_path", tool.truncated_path},
          {"near_singular", tool.near_singular},
          {"depth_max_m", tool.depth_max_m},
          {"force_max_n", tool.force_max_n},
          {"stiffness_max_n_per_m", tool.stiffness_max_n_per_m},
          {"error_relative_max", tool.error_relative_max},
          {"direction_spread_max_rad", tool.direction_spread_max_rad},
          {"budget_relative", tool.accuracy.budget_relative},
          {"checked", tool.accuracy.verified},
          {"checked_between_nodes", tool.accuracy.between_nodes},
          {"error_factor", tool.accuracy.error_factor},
          {"hard_error_factor", tool.accuracy.hard_error_factor},
          {"error_covered", tool.accuracy.covered},
          {"hard_error_covered", tool.accuracy.hard_covered},
          {"error_depth_share", tool.accuracy.depth_share},
          {"error_covering_relative", tool.accuracy.covering_relative},
          {"relaxation", to_json(tool.relaxation)},
          {"viscoelasticity", viscoelasticity_json(tool)},
          {"yielding", yielding_json(tool)},
          {"contacts", contacts_json(tool.tool)},
          {"compliance", compliance_json(tool.compliance)},
          {"contact", tool.contact},
          {"puncture", puncture_json(tool)}};
}

// Of all nodes.
Eigen::Vector3d size_m(const DatabaseIndex& index) {
  return (index.box_max_m.colwise().maxCoeff() - index.box_min_m.colwise().minCoeff())
      .transpose();
}

Json to_json(const DatabaseIndex& index) {
  Json names = Json::array();
  Json details = Json::array();
  double depth_max_m = 0.0;
  for (const ToolIndex& tool : index.tools) {
    const ToolSummary summary = summarise(tool);
    names.push_back(tool.tool.name);
    details.push_back(to_json(summary));
    depth_max_m = std::max(depth_max_m, summary.depth_max_m);
  }
  const Eigen::Vector3d size = size_m(index);
  return {{"format_version", kDatabaseVersion},
          {"nodes", index.nodes()},
          {"triangles", index.triangles()},
          {"tools", names},
          {"depth_max_m", depth_max_m},
          {"bytes", index.bytes},
          {"size_m", {size.x(), size.y(), size.z()}},
          {"tool_details", details},
          {"measured_samples", index.measured_samples},
          {"precision", name_of(index.storage.precision)},
          {"compressed", index.storage.compress},
          {"chunks", index.chunks()},
          {"writer", index.provenance.writer},
          {"source_file", index.provenance.source_file},
          {"source_sha256", index.provenance.source_sha256},
          {"left_out", index.provenance.left_out}};
}

void print(const ToolSummary& tool) {
  fmt::print("tool       {}: {}, friction {:.3g}, presliding {:.3g} mm\n",
             printable(tool.tool.name), describe_tool(tool.tool, tool.puncture),
             tool.tool.friction, 1e3 * tool.tool.presliding_m);
  fmt::print("responses  {} ({} simulated, {} interpolated, {} measured)\n",
             tool.responses, tool.simulated, tool.interpolated, tool.measured);
  fmt::print(
      "flags      {} falling, {} force capped, {} coarse contact, {} over the "
      "error budget, {} failed, {} with a path that was hard to follow\n",
      tool.falling, tool.force_capped, tool.coarse_contact, tool.error_over_budget,
      tool.failed, tool.near_singular);
  fmt::print(
      "largest    depth {:.4g} mm, force {:.4g} N, stiffness {:.4g} N/m, "
      "relative error {:.2g}\n",
      1e3 * tool.depth_max_m, tool.force_max_n, tool.stiffness_max_n_per_m,
      tool.error_relative_max);
  if (const std::string errors = describe(tool.accuracy); !errors.empty()) {
    fmt::print("errors     {}\n", errors);
  }
  if (!tool.relaxation.empty()) {
    fmt::print("relaxation {}; not rendered\n", describe(tool.relaxation));
  }
  if (!tool.viscoelasticity.empty()) {
    fmt::print("relaxation {}\n", describe(tool.viscoelasticity, tool.shares));
  }
  if (!tool.yielding.empty()) {
    fmt::print("yielding   {}\n", tool.yielding);
  }
  if (!tool.viscoelasticity.empty() || !tool.yielding.empty()) {
    fmt::print("memory     {}\n", describe_memory(tool));
  }
  if (!tool.compliance.empty()) {
    fmt::print("coupling   {}\n", describe(tool.compliance));
  }
  if (!tool.contact.empty()) {
    fmt::print("contact    {}\n", tool.contact);
  }
  if (!tool.puncture.empty()) {
    fmt::print("puncture   {}\n", printable(describe_puncture(tool)));
  }
}

void print(const DatabaseIndex& index) {
  const Eigen::Vector3d size = 1e3 * size_m(index);
  const Provenance& provenance = index.provenance;
  fmt::print("format     version {}, {} bytes, by {}\n", kDatabaseVersion, index.bytes,
             printable(provenance.writer));
  fmt::print("storage    {}{}, {} chunks\n", name_of(index.storage.precision),
             index.storage.compress ? " compressed" : "", index.chunks());
  fmt::print("body       {} nodes, {} triangles, {:.4g} x {:.4g} x {:.4g} mm\n",
             index.nodes(), index.triangles(), size.x(), size.y(), size.z());
  fmt::print("source     {}, SHA-256 {}\n", printable(provenance.source_file),
             provenance.source_sha256.empty() ? "unknown" : provenance.source_sha256);
  if (index.measured_samples > 0) {
    fmt::print("measured   {} samples\n", index.measured_samples);
  }
  if (!provenance.left_out.empty()) {
    fmt::print("left out   {}\n", printable(provenance.left_out));
  }
  for (const ToolIndex& tool : index.tools) {
    print(summarise(tool));
  }
}

void run_info(const InfoFlags& flags) {
  const DatabaseIndex index = read_index(flags.file);
  if (flags.json) {
    // Texts come from a file: what is not UTF-8 is replaced, not refused.
    fmt::print("{}\n", json_text(to_json(index)));
  } else {
    print(index);
  }
}

}  // namespace

void add_info_command(Command app) {
  Command command = app.add_subcommand("info", "Say what a response database holds");
  auto flags = std::make_shared<InfoFlags>();
  command.add_option("file", flags->file, "Response database (HDF5 or flat)")
      .required();
  command.add_flag("--json", flags->json, "Print the report as one JSON object");
  command.callback([flags] {
    run_info(*flags);
  });
}

}  // namespace palpate

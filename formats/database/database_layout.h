// What a database file holds and in which order, once for both directions; only for the
// sources behind response_database.h.
//
// `File` is a StoredWriter and the rest constant, or a StoredReader and the rest to be
// filled. The order is the digest's order.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>

#include "formats/base/lines.h"
#include "formats/database/compliance_layout.h"
#include "formats/database/contact_layout.h"
#include "formats/database/puncture_layout.h"
#include "formats/database/response_database.h"
#include "formats/database/select_nodes.h"
#include "formats/database/shape_layout.h"
#include "formats/database/vtk_cells.h"
#include "formats/stored/storage_options.h"
#include "formats/stored/stored_reader.h"
#include "formats/stored/stored_writer.h"

namespace palpate::content {

constexpr const char* kFormatName = "palpate-response-database";

// Texts of one line each, as one text.
template <typename File, typename Lines>
void exchange_lines(File& file, const std::string& path, Lines& lines) {
  if (!file.optional_dataset(path, !lines.empty())) {
    return;
  }
  if constexpr (File::kWrites) {
    file.text(path, join_lines(lines));
  } else {
    std::string text;
    file.text(path, text);
    lines = split_lines(text);
  }
}

template <typename File, typename Accuracy>
void exchange_accuracy(File& file, const std::string& group, Accuracy& accuracy) {
  if (file.optional_group(group, accuracy.budget_relative > 0.0)) {
    file.attribute(group, "budget_relative", accuracy.budget_relative);
    file.attribute(group, "verified", accuracy.verified);
    exchange_number(file, group, "between_nodes", accuracy.between_nodes);
    exchange_number(file, group, "error_factor", accuracy.error_factor);
    exchange_number(file, group, "hard_error_factor", accuracy.hard_error_factor);
    exchange_number(file, group, "covered", accuracy.covered);
    exchange_number(file, group, "hard_covered", accuracy.hard_covered);
    exchange_if_any(file, group + "/quantile_level", "1", accuracy.quantile_level);
    exchange_if_any(file, group + "/error_relative", "1", accuracy.error_relative);
    exchange_if_any(file, group + "/depth_share", "1", accuracy.depth_share);
    exchange_if_any(file, group + "/covering_relative", "1",
                    accuracy.covering_relative);
  }
}

// What a computation says about its own responses.
template <typename File, typename Table>
void exchange_quality(File& file, const std::string& group, Table& table) {
  exchange_if_any(file, group + "/verified_error_relative", "1",
                  table.verified_error_relative);
  exchange_if_any(file, group + "/failure", "1", table.failure);
  exchange_lines(file, group + "/failure_reason", table.failure_reason);
  exchange_if_any(file, group + "/history", "1", table.history);
  exchange_lines(file, group + "/history_text", table.history_text);
  exchange_if_any(file, group + "/force_n_errors", "N", table.force_errors_n);
  exchange_if_any(file, group + "/direction_begin", "1", table.direction_begin);
  exchange_if_any(file, group + "/sample_direction", "1", table.sample_direction);
  exchange_accuracy(file, group + "/accuracy", table.accuracy);
}

// The one place where their names stand.
template <typename File, typename Table>
void exchange_tilts(File& file, const std::string& group, Table& table) {
  file.dataset(group + "/tilt", "1", table.tilt);
  file.dataset(group + "/tilt_by_depth_per_m", "m-1", table.tilt_by_depth_per_m);
}

template <typename File, typename Field>
void exchange_displacement(File& file, const std::string& group, Field& field) {
  if (file.optional_group(group, field.coefficient.rows() > 0)) {
    file.vectors(group + "/basis", "1", field.basis);
    file.dataset(group + "/coefficient_m", "m", field.coefficient);
    file.dataset(group + "/node", "1", field.node);
    file.dataset(group + "/depth_m", "m", field.depth_m);
    file.dataset(group + "/error_relative", "1", field.error_relative);
  }
}

template <typename File, typename Terms>
void exchange_prony(File& file, const std::string& group, Terms& terms) {
  file.dataset(group + "/g_1", "1", terms.g_1);
  file.dataset(group + "/g_2", "1", terms.g_2);
  file.dataset(group + "/tau_1_s", "s", terms.tau_1_s);
  file.dataset(group + "/tau_2_s", "s", terms.tau_2_s);
}

// What holds showed, of which nothing is rendered: of files before version 2.2 all that
// they say of time.
template <typename File, typename Relaxation>
void exchange_relaxation(File& file, const std::string& group, Relaxation& relaxation) {
  if (file.optional_dataset(group + "/g_1", !relaxation.empty())) {
    file.group(group);
    file.attribute(group, "rule", relaxation.rule);
    file.attribute(group, "probes", relaxation.probes);
    file.attribute(group, "speed_m_per_s", relaxation.speed_m_per_s);
    file.attribute(group, "seconds", relaxation.seconds);
    exchange_prony(file, group, relaxation.terms);
  }
}

// Of how responses relax what is the same for all nodes.
template <typename File, typename Relaxation>
void exchange_relaxation_head(File& file, const std::string& group,
                              Relaxation& relaxation) {
  constexpr const char* kPress = "press";
  std::string curve = relaxation.instantaneous ? "instantaneous" : kPress;
  std::int64_t terms = relaxation.terms();
  file.attribute(group, "rule", relaxation.rule);
  file.attribute(group, "curve", curve);
  file.attribute(group, "terms", terms);
  exchange_number(file, group, "probes", relaxation.probes);
  exchange_number(file, group, "speed_m_per_s", relaxation.speed_m_per_s);
  file.dataset(group + "/tau_s", "s", relaxation.tau_s);
  if constexpr (!File::kWrites) {
    if (curve != kPress && curve != "instantaneous") {
      file.fail(fmt::format(
          "attribute {}@curve is {:?}, must be \"press\" or \"instantaneous\"", group,
          curve.substr(0, 80)));
    }
    relaxation.instantaneous = curve != kPress;
    if (terms != relaxation.terms()) {
      file.fail(fmt::format("attribute {}@terms is {}, must be the rows of tau_s: {}",
                            group, terms, relaxation.terms()));
    }
  }
}

// Of the sites what is the same for all nodes.
template <typename File, typename Relaxation>
void exchange_sites_head(File& file, const std::string& group, Relaxation& relaxation) {
  std::int64_t bundles = relaxation.bundles();
  auto& sites = relaxation.sites;
  exchange_number(file, group, "spacing_m", sites.spacing_m);
  file.attribute(group, "bundles", bundles);
  exchange_if_any(file, group + "/bundle_depth_m", "m", relaxation.bundle_depth_m);
  if constexpr (!File::kWrites) {
    if (bundles != relaxation.bundles()) {
      file.fail(
          fmt::format("attribute {}@bundles is {}, must be one more than "
                      "bundle_depth_m has rows: {}",
                      group, bundles, relaxation.bundles()));
    }
  }
}

// How responses relax, as it is rendered, and where the surface remembers it. The one
// place where the groups' names stand.
struct ViscoelasticityGroups {
  explicit ViscoelasticityGroups(const std::string& tool)
      : relaxation(tool + "/relaxation"), memory(tool + "/memory") {}
  std::string relaxation;
  std::string memory;
};

// How they yield for good.
template <typename File, typename Rows>
void exchange_yielding(File& file, const std::string& tool, Rows& yielding) {
  const bool dents = file.optional_group(tool + "/plastic", !yielding.share.empty());
  const bool softens = file.optional_group(tool + "/damage", !yielding.largest.empty());
  for_each_dataset(yielding,
                   [&](const std::string& name, const char* units, auto& values) {
                     if (name.starts_with("/plastic") ? dents : softens) {
                       file.dataset(tool + name, units, values);
                     }
                   });
}

template <typename File, typename Relaxation>
void exchange_viscoelasticity(File& file, const std::string& tool,
                              Relaxation& relaxation) {
  const ViscoelasticityGroups groups(tool);
  if (file.optional_dataset(groups.relaxation + "/tau_s", !relaxation.empty())) {
    file.group(groups.relaxation);
    exchange_relaxation_head(file, groups.relaxation, relaxation);
    file.dataset(groups.relaxation + "/g", "1", relaxation.g);
    exchange_if_any(file, groups.relaxation + "/error_relative", "1",
                    relaxation.error_relative);
  }
  exchange_yielding(file, tool, relaxation.yielding);
  auto& sites = relaxation.sites;
  if (file.optional_group(groups.memory, !sites.empty() || relaxation.bundles() > 1)) {
    exchange_sites_head(file, groups.memory, relaxation);
    if (file.optional_dataset(groups.memory + "/site", !sites.empty())) {
      file.dataset(groups.memory + "/site_node", "1", sites.node);
      file.dataset(groups.memory + "/site", "1", sites.site);
      file.dataset(groups.memory + "/weight", "1", sites.weight);
    }
  }
}

// One row per node.
template <typename File, typename Table>
void exchange_nodes(File& file, const std::string& group, Table& table) {
  file.dataset(group + "/direction", "1", table.direction);
  file.dataset(group + "/direction_spread_rad", "rad", table.direction_spread_rad);
  file.dataset(group + "/touch_offset_m", "m", table.touch_offset_m);
  file.dataset(group + "/error_relative", "1", table.error_relative);
  file.dataset(group + "/friction", "1", table.friction);
  file.dataset(group + "/presliding_m", "m", table.presliding_m);
  file.dataset(group + "/stiffness_max_n_per_m", "N m-1", table.stiffness_max_n_per_m);
  file.dataset(group + "/origin", "1", table.origin);
  file.flags(group + "/origin", {0, 1, 2, 3}, "none simulated interpolated measured",
             false);
  file.dataset(group + "/flags", "1", table.flags);
  file.flags(group + "/flags",
             {kFallingCurve, kForceCapped, kCoarseContact, kErrorOverBudget, kFailed,
              kExtrapolated, kTruncatedPath, kNearSingular},
             "falling_curve force_capped coarse_contact error_over_budget failed "
             "extrapolated truncated_path near_singular",
             true);
  file.begins(group + "/sample_begin", table.sample_begin);
}

// One row per sample of every node's curve.
template <typename File, typename Table>
void exchange_samples(File& file, const std::string& group, Table& table) {
  const std::string slope = group + "/stiffness_n_per_m";
  const std::string energy = group + "/energy_j";
  file.reals(group + "/depth_m", "m", table.depth_m, table.sample_begin);
  file.reals(group + "/force_n", "N", table.force_n, table.sample_begin);
  if (file.keeps_slopes(slope)) {
    file.samples(slope, "N m-1", table.stiffness_n_per_m);
    file.samples(energy, "J", table.energy_j);
    return;
  }
  if constexpr (!File::kWrites) {
    remake_curves(table);
  }
  file.digest_only(slope, table.stiffness_n_per_m);
  file.digest_only(energy, table.energy_j);
}

template <typename File, typename Table>
void exchange_tool(File& file, const std::string& group, Table& table) {
  exchange_shape(file, group, table.tool);
  exchange_nodes(file, group, table);
  exchange_samples(file, group, table);
  exchange_quality(file, group, table);
  if (file.optional_dataset(group + "/tilt", table.tilt.rows() > 0)) {
    exchange_tilts(file, group, table);
  }
  exchange_displacement(file, group + "/displacement", table.displacement);
  exchange_relaxation(file, group + "/relaxation", table.relaxation);
  exchange_viscoelasticity(file, group, table.viscoelasticity);
  exchange_compliance(file, group, table.compliance);
  exchange_puncture(file, group, table.puncture);
  exchange_contact(file, group, table.contact);
}

template <typename File, typename Measured>
void exchange_measurement(File& file, Measured& measurement) {
  file.dataset("/measurement/depth_m", "m", measurement.depth_m);
  file.dataset("/measurement/force_n", "N", measurement.force_n);
  exchange_if_any(file, "/measurement/time_s", "s", measurement.time_s);
  exchange_if_any(file, "/measurement/depth_m_errors", "m", measurement.depth_errors_m);
  exchange_if_any(file, "/measurement/force_n_errors", "N", measurement.force_errors_n);
  exchange_if_any(file, "/measurement/run_begin", "1", measurement.run_begin);
  exchange_if_any(file, "/measurement/run_node", "1", measurement.run_node);
  exchange_lines(file, "/measurement/run_name", measurement.run_name);
  auto& relaxation = measurement.relaxation;
  const std::string group = "/measurement/relaxation";
  if (file.optional_group(group, relaxation.terms.size() > 0)) {
    exchange_prony(file, group, relaxation.terms);
    file.dataset(group + "/speed_m_per_s", "m s-1", relaxation.speed_m_per_s);
    file.dataset(group + "/seconds", "s", relaxation.seconds);
    file.dataset(group + "/rms_relative", "1", relaxation.rms_relative);
  }
}

// Provenance without the scene, which can be long.
template <typename File, typename Source>
void exchange_source(File& file, Source& provenance) {
  file.group("/provenance");
  file.attribute("/provenance", "source_file", provenance.source_file);
  file.attribute("/provenance", "source_sha256", provenance.source_sha256);
  file.attribute("/provenance", "left_out", provenance.left_out);
  if (file.optional_attribute("/provenance", "plan_sha256",
                              !provenance.plan_sha256.empty())) {
    file.attribute("/provenance", "plan_sha256", provenance.plan_sha256);
  }
}

// How the file stores what it holds: no part of the content, nor of its digest.
inline void exchange_storage(StoredWriter& file, const StorageOptions& storage) {
  file.group("/storage");
  file.remark("/storage", "precision", name_of(storage.precision));
  file.remark("/storage", "compression", storage.compress ? "deflate" : "none");
  file.remark("/storage", "chunk_nodes", storage.chunk_nodes);
}
void exchange_storage(StoredReader& file, StorageOptions& storage);

/// @throws FormatError if the file is of another kind or major version.
void read_version(StoredReader& file);
[[nodiscard]] std::vector<std::string> read_tool_names(StoredReader& file);

template <typename File, typename Database, typename Order>
void exchange_rest(File& file, Database& database, Order& order) {
  file.group("/body");
  file.dataset("/body/position_m", "m", database.body.position_m);
  file.dataset("/body/triangle", "1", database.body.triangle);
  file.dataset("/body/normal", "1", database.normal);
  file.dataset("/body/source_node", "1", order.node);
  file.dataset("/body/source_triangle", "1", order.triangle);
  auto& measurement = database.measurement;
  if (file.optional_group("/measurement", !measurement.depth_m.empty())) {
    exchange_measurement(file, measurement);
  }
  exchange_source(file, database.provenance);
  file.text("/provenance/scene_toml", database.provenance.scene_toml);
}

// The body as VTK's readers know it, outside the digest: all of it follows from the
// rest. What VTK can use as it is stored is a link and takes no room. Of a form that
// VTK does not read there is nothing.
template <typename File>
void exchange_vtk(File& file, const ResponseDatabase& database) {
  if (!file.shows_vtk()) {
    return;
  }
  const std::string group = "/VTKHDF";
  const VtkCells cells = vtk_cells(database.body);
  file.group(group);
  file.vtk_header(group);
  file.link(group + "/Points", "/body/position_m");
  file.derived(group + "/NumberOfPoints", "1", cells.points);
  file.derived(group + "/NumberOfCells", "1", cells.cells);
  file.derived(group + "/NumberOfConnectivityIds", "1", cells.corners);
  file.derived(group + "/Connectivity", "1", cells.connectivity);
  file.derived(group + "/Offsets", "1", cells.offset);
  file.derived(group + "/Types", "1", cells.type);
  file.group(group + "/PointData");
  for (const ResponseTable& table : database.tools) {
    const bool first = &table == &database.tools.front();
    const std::string tool = "/tools/" + table.tool.name;
    const auto data = [&](const char* name) {
      return fmt::format("{}/PointData/{}{}{}", group, name, first ? "" : "_",
                         first ? "" : table.tool.name);
    };
    file.link(data("stiffness"), tool + "/stiffness_max_n_per_m");
    file.link(data("error"), tool + "/error_relative");
    file.link(data("origin"), tool + "/origin");
    file.link(data("flags"), tool + "/flags");
    file.derived(data("depth_max"), "m", node_depth_max_m(table));
  }
}

}  // namespace palpate::content

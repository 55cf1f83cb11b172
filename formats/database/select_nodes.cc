#include "formats/database/select_nodes.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/mesh/space_curve.h"
#include "formats/response/response_curve.h"

namespace palpate {
namespace {

using Nodes = std::span<const std::int32_t>;

std::size_t index(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

// Per-node values; what is absent stays so.
template <typename T>
std::vector<T> rows_at(const std::vector<T>& values, Nodes nodes) {
  std::vector<T> rows;
  if (!values.empty()) {
    rows.reserve(nodes.size());
    for (const std::int32_t node : nodes) {
      rows.push_back(values[index(node)]);
    }
  }
  return rows;
}

template <typename Matrix>
Matrix rows_at(const Matrix& values, Nodes nodes) {
  Matrix rows(static_cast<Eigen::Index>(nodes.size()), values.cols());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = values.row(nodes[i]);
  }
  return rows;
}

// Values of which node i owns [begin[i], begin[i + 1]).
std::vector<double> runs_of(const std::vector<double>& values,
                            const std::vector<std::int64_t>& begin, Nodes nodes) {
  std::vector<double> runs;
  if (!values.empty()) {
    for (const std::int32_t node : nodes) {
      runs.insert(runs.end(), values.begin() + begin[index(node)],
                  values.begin() + begin[index(node) + 1]);
    }
  }
  return runs;
}

std::vector<std::int64_t> begins_of(const std::vector<std::int64_t>& begin,
                                    Nodes nodes) {
  std::vector<std::int64_t> begins;
  if (!begin.empty()) {
    begins.push_back(0);
    for (const std::int32_t node : nodes) {
      begins.push_back(begins.back() + begin[index(node) + 1] - begin[index(node)]);
    }
  }
  return begins;
}

void select_sample_directions(const ResponseTable& table, Nodes nodes,
                              ResponseTable& selected) {
  selected.direction_begin = begins_of(table.direction_begin, nodes);
  if (table.direction_begin.empty()) {
    return;
  }
  selected.sample_direction.resize(selected.direction_begin.back(), 3);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::int64_t count =
        selected.direction_begin[i + 1] - selected.direction_begin[i];
    selected.sample_direction.middleRows(selected.direction_begin[i], count) =
        table.sample_direction.middleRows(table.direction_begin[index(nodes[i])],
                                          count);
  }
}

DisplacementField select_displacement(const DisplacementField& field, Nodes nodes,
                                      std::size_t all) {
  DisplacementField selected;
  const std::vector<std::int32_t> place = places_of(nodes, all);
  std::vector<std::int32_t> kept;
  for (std::size_t j = 0; j < field.node.size(); ++j) {
    if (place[index(field.node[j])] >= 0) {
      kept.push_back(static_cast<std::int32_t>(j));
      selected.node.push_back(place[index(field.node[j])]);
    }
  }
  if (kept.empty()) {
    return {};
  }
  selected.coefficient = rows_at(field.coefficient, kept);
  selected.depth_m = rows_at(field.depth_m, kept);
  selected.error_relative = rows_at(field.error_relative, kept);
  selected.basis.resize(3 * static_cast<Eigen::Index>(nodes.size()),
                        field.basis.cols());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    selected.basis.middleRows(3 * static_cast<Eigen::Index>(i), 3) =
        field.basis.middleRows(3 * Eigen::Index{nodes[i]}, 3);
  }
  return selected;
}

PronyTerms select_terms(const PronyTerms& terms, Nodes nodes) {
  return {rows_at(terms.g_1, nodes), rows_at(terms.g_2, nodes),
          rows_at(terms.tau_1_s, nodes), rows_at(terms.tau_2_s, nodes)};
}

// Sites of which some selected node reads one, in their order.
MemorySites select_sites(const MemorySites& sites, Nodes nodes,
                         const std::vector<std::int32_t>& place) {
  MemorySites selected;
  if (sites.empty()) {
    return selected;
  }
  selected.spacing_m = sites.spacing_m;
  selected.site = rows_at(sites.site, nodes);
  selected.weight = rows_at(sites.weight, nodes);
  // row: -1 not read by a selected node, 0 read; then its new number.
  std::vector<std::int32_t> row(sites.node.size(), -1);
  for (const std::int32_t site : selected.site.reshaped()) {
    if (site >= 0) {
      row[index(site)] = 0;
    }
  }
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == 0) {
      row[i] = static_cast<std::int32_t>(selected.node.size());
      const std::int32_t node = sites.node[i];
      // A site at a node that is not selected stays as a site without a node.
      selected.node.push_back(node >= 0 ? place[index(node)] : -1);
    }
  }
  for (std::int32_t& site : selected.site.reshaped()) {
    site = site >= 0 ? row[index(site)] : -1;
  }
  return selected;
}

Viscoelasticity select_viscoelasticity(const Viscoelasticity& all, Nodes nodes,
                                       std::size_t size) {
  Viscoelasticity selected = all;
  if (all.g.rows() > 1) {
    selected.g = rows_at(all.g, nodes);
  }
  if (all.error_relative.size() > 1) {
    selected.error_relative = rows_at(all.error_relative, nodes);
  }
  for_each_dataset(selected.yielding, [&](const auto&, const auto&, auto& values) {
    if (values.size() > 1) {
      values = rows_at(values, nodes);
    }
  });
  selected.sites = select_sites(all.sites, nodes, places_of(nodes, size));
  return selected;
}

}  // namespace

std::vector<std::int32_t> places_of(Nodes order, std::size_t size) {
  std::vector<std::int32_t> place(size, -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[index(order[i])] = static_cast<std::int32_t>(i);
  }
  return place;
}

ResponseTable select_nodes(const ResponseTable& table, Nodes nodes) {
  ResponseTable selected;
  selected.tool = table.tool;
  selected.direction = rows_at(table.direction, nodes);
  selected.direction_spread_rad = rows_at(table.direction_spread_rad, nodes);
  selected.touch_offset_m = rows_at(table.touch_offset_m, nodes);
  selected.error_relative = rows_at(table.error_relative, nodes);
  selected.friction = rows_at(table.friction, nodes);
  selected.presliding_m = rows_at(table.presliding_m, nodes);
  selected.stiffness_max_n_per_m = rows_at(table.stiffness_max_n_per_m, nodes);
  selected.origin = rows_at(table.origin, nodes);
  selected.flags = rows_at(table.flags, nodes);
  // Runs of samples by node, with new beginnings.
  selected.sample_begin = begins_of(table.sample_begin, nodes);
  selected.depth_m = runs_of(table.depth_m, table.sample_begin, nodes);
  selected.force_n = runs_of(table.force_n, table.sample_begin, nodes);
  selected.stiffness_n_per_m =
      runs_of(table.stiffness_n_per_m, table.sample_begin, nodes);
  selected.energy_j = runs_of(table.energy_j, table.sample_begin, nodes);
  selected.verified_error_relative = rows_at(table.verified_error_relative, nodes);
  selected.failure = rows_at(table.failure, nodes);
  selected.failure_reason = table.failure_reason;
  selected.history = rows_at(table.history, nodes);
  selected.history_text = table.history_text;
  selected.force_errors_n = runs_of(table.force_errors_n, table.sample_begin, nodes);
  select_sample_directions(table, nodes, selected);
  const Nodes with_tilt = table.tilt.rows() == 0 ? Nodes{} : nodes;
  selected.tilt = rows_at(table.tilt, with_tilt);
  selected.tilt_by_depth_per_m = rows_at(table.tilt_by_depth_per_m, with_tilt);
  selected.accuracy = table.accuracy;
  selected.displacement = select_displacement(table.displacement, nodes,
                                              static_cast<std::size_t>(table.nodes()));
  selected.relaxation = table.relaxation;
  if (table.relaxation.terms.size() > 1) {
    selected.relaxation.terms = select_terms(table.relaxation.terms, nodes);
  }
  selected.viscoelasticity = select_viscoelasticity(
      table.viscoelasticity, nodes, static_cast<std::size_t>(table.nodes()));
  selected.compliance = table.compliance;
  selected.compliance.value =
      rows_at(table.compliance.value, table.compliance.empty() ? Nodes{} : nodes);
  selected.compliance.mode = rows_at(
      table.compliance.mode, table.compliance.mode.size() == 0 ? Nodes{} : nodes);
  selected.puncture = rows_of(table.puncture, nodes);
  selected.contact = rows_of(table.contact, nodes);
  return selected;
}

ResponseDatabase select_nodes(const ResponseDatabase& database, Nodes nodes,
                              Nodes triangles) {
  const auto n = static_cast<std::size_t>(database.body.position_m.rows());
  const std::vector<std::int32_t> place = places_of(nodes, n);
  ResponseDatabase selected;
  selected.body.position_m = rows_at(database.body.position_m, nodes);
  selected.body.triangle =
      rows_at(database.body.triangle, triangles).unaryExpr([&](std::int32_t node) {
        return place[index(node)];
      });
  selected.normal = rows_at(database.normal, nodes);
  for (const ResponseTable& table : database.tools) {
    selected.tools.push_back(select_nodes(table, nodes));
  }
  selected.measurement = database.measurement;
  for (std::int32_t& node : selected.measurement.run_node) {
    node = node < 0 ? node : place[index(node)];
  }
  selected.provenance = database.provenance;
  selected.storage = database.storage;
  return selected;
}

StorageOrder storage_order(const SurfaceMesh& body) {
  StorageOrder order;
  order.node = curve_order(body.position_m);
  const std::vector<std::int32_t> place = places_of(order.node, order.node.size());
  const auto t = static_cast<std::size_t>(body.triangle.rows());
  std::vector<std::int32_t> first(t);
  for (std::size_t i = 0; i < t; ++i) {
    const auto corner = body.triangle.row(static_cast<Eigen::Index>(i));
    first[i] = std::min(
        {place[index(corner[0])], place[index(corner[1])], place[index(corner[2])]});
  }
  order.triangle.resize(t);
  std::iota(order.triangle.begin(), order.triangle.end(), 0);
  std::stable_sort(order.triangle.begin(), order.triangle.end(),
                   [&](std::int32_t a, std::int32_t b) {
                     return first[index(a)] < first[index(b)];
                   });
  return order;
}

void remake_curves(ResponseTable& table) {
  const std::vector<std::int64_t>& begin = table.sample_begin;
  const auto s = static_cast<std::int64_t>(table.depth_m.size());
  if (begin.empty() || begin.front() != 0 || begin.back() != s ||
      !std::is_sorted(begin.begin(), begin.end()) ||
      table.force_n.size() != table.depth_m.size()) {
    throw FormatError(fmt::format(
        "/tools/{}/sample_begin does not divide the {} samples among the nodes",
        table.tool.name, s));
  }
  table.stiffness_n_per_m.assign(table.depth_m.size(), 0.0);
  table.energy_j.assign(table.depth_m.size(), 0.0);
  for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
    const auto at = static_cast<std::size_t>(begin[i]);
    const auto count = static_cast<std::size_t>(begin[i + 1]) - at;
    if (count == 0) {
      continue;
    }
    try {
      // Slopes and energies are functions of depths and forces.
      const ResponseCurve curve(std::span(table.depth_m).subspan(at, count),
                                std::span(table.force_n).subspan(at, count));
      const CurveView view = curve.view();
      std::ranges::copy(view.stiffness_n_per_m,
                        table.stiffness_n_per_m.begin() + begin[i]);
      std::ranges::copy(view.energy_j, table.energy_j.begin() + begin[i]);
    } catch (const InputError& error) {
      throw FormatError(
          fmt::format("/tools/{}: node {}: {}", table.tool.name, i, error.what()));
    }
  }
}

}  // namespace palpate

#include "formats/response/response_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/response/response_curve.h"
#include "formats/response/response_rules.h"

namespace palpate {
namespace {

void append_curve(ResponseTable& table, const NodeResponse& response,
                  std::size_t node) {
  const std::string broken = broken_rule(response);
  if (!broken.empty()) {
    throw InputError(fmt::format("node {}: {}", node, broken));
  }
  try {
    const ResponseCurve curve(response.depth_m, response.force_n);
    const CurveView view = curve.view();
    const auto append = [](std::vector<double>& to, std::span<const double> from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(table.depth_m, view.depth_m);
    append(table.force_n, view.force_n);
    append(table.stiffness_n_per_m, view.stiffness_n_per_m);
    append(table.energy_j, view.energy_j);
    table.stiffness_max_n_per_m.back() = curve.stiffness_max_n_per_m();
    if (curve.falls()) {
      table.flags.back() |= kFallingCurve;
    }
  } catch (const InputError& error) {
    throw InputError(fmt::format("node {}: {}", node, error.what()));
  }
}

// Rows of `sample_direction` for the nodes that have them; nothing where none has.
void fill_sample_directions(ResponseTable& table,
                            const std::vector<NodeResponse>& responses) {
  std::vector<Eigen::Vector3d> rows;
  table.direction_begin.push_back(0);
  for (const NodeResponse& response : responses) {
    rows.insert(rows.end(), response.sample_direction.begin(),
                response.sample_direction.end());
    table.direction_begin.push_back(static_cast<std::int64_t>(rows.size()));
  }
  if (rows.empty()) {
    table.direction_begin.clear();
  }
  table.sample_direction.resize(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    table.sample_direction.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  }
}

// Rows of tilts where every response has one.
void fill_tilts(ResponseTable& table, const std::vector<NodeResponse>& responses) {
  bool any = false;
  for (const NodeResponse& response : responses) {
    if (response.origin != ResponseOrigin::kNone && !response.tilt) {
      return;
    }
    any = any || response.tilt.has_value();
  }
  if (!any) {
    return;
  }
  const auto n = static_cast<Eigen::Index>(responses.size());
  table.tilt = Points::Zero(n, 3);
  table.tilt_by_depth_per_m = Points::Zero(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (const auto& line = responses[static_cast<std::size_t>(i)].tilt) {
      table.tilt.row(i) = line->tilt.transpose();
      table.tilt_by_depth_per_m.row(i) = line->by_depth_per_m.transpose();
    }
  }
}

// [-] S of a ball on a half-space of nu 0.45 (contact_table.h), where nobody knows it.
constexpr double kUsualLateral = 3.0 * 0.55 / 1.55;
constexpr double kNoPreslidingM = 1e-3;  // of a tool without responses

double median_or(double none, std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return values.empty() ? none : *half;
}

// Presliding displacements at the last depths, mu d / S, for those that know one number
// alone: with the mean of S over directions.
void derive_presliding(ResponseTable& table) {
  std::vector<double> lateral(table.presliding_m.size(), 0.0);
  std::vector<double> known;
  for (std::size_t i = 0; i < lateral.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (table.contact.has_lateral() && table.contact.lateral(row, 0) > 0.0F) {
      lateral[i] = 0.5 * lateral_at(table.contact, row, 1.0).trace();
      known.push_back(lateral[i]);
    }
  }
  const double usual = median_or(kUsualLateral, known);
  std::vector<double> presliding;
  for (std::size_t i = 0; i < lateral.size(); ++i) {
    const CurveView curve = table.curve(static_cast<std::int64_t>(i));
    if (!curve.depth_m.empty()) {
      presliding.push_back(table.friction[i] * curve.depth_m.back() /
                           (lateral[i] > 0.0 ? lateral[i] : usual));
      table.presliding_m[i] = presliding.back();
    }
  }
  table.tool.presliding_m = median_or(kNoPreslidingM, presliding);
  for (double& presliding_m : table.presliding_m) {
    presliding_m = presliding_m > 0.0 ? presliding_m : table.tool.presliding_m;
  }
  table.tool.presliding_computed = false;
}

}  // namespace

CurveView ResponseTable::curve(std::int64_t node) const noexcept {
  const auto i = static_cast<std::size_t>(node);
  const auto begin = static_cast<std::size_t>(sample_begin[i]);
  const auto count = static_cast<std::size_t>(sample_begin[i + 1]) - begin;
  return {std::span(depth_m).subspan(begin, count),
          std::span(force_n).subspan(begin, count),
          std::span(stiffness_n_per_m).subspan(begin, count),
          std::span(energy_j).subspan(begin, count)};
}

double ResponseTable::depth_max_m() const noexcept {
  return depth_m.empty() ? 0.0 : *std::max_element(depth_m.begin(), depth_m.end());
}

ResponseTable make_table(const ToolShape& tool,
                         const std::vector<NodeResponse>& responses) {
  const std::size_t n = responses.size();
  ResponseTable table;
  table.tool = tool;
  table.direction = Points::Zero(static_cast<Eigen::Index>(n), 3);
  table.friction.assign(n, tool.friction);
  table.presliding_m.assign(n, tool.presliding_m);
  table.sample_begin.push_back(0);
  for (std::size_t i = 0; i < n; ++i) {
    const NodeResponse& response = responses[i];
    table.direction_spread_rad.push_back(response.direction_spread_rad);
    table.touch_offset_m.push_back(response.touch_offset_m);
    table.error_relative.push_back(response.error_relative);
    table.origin.push_back(static_cast<std::uint8_t>(response.origin));
    table.flags.push_back(response.flags);
    table.stiffness_max_n_per_m.push_back(0.0);
    if (response.origin != ResponseOrigin::kNone) {
      table.direction.row(static_cast<Eigen::Index>(i)) =
          response.direction.transpose();
      append_curve(table, response, i);
    }
    table.sample_begin.push_back(static_cast<std::int64_t>(table.depth_m.size()));
  }
  fill_sample_directions(table, responses);
  fill_tilts(table, responses);
  std::vector<const ContactTable*> contact;
  for (const NodeResponse& response : responses) {
    contact.push_back(&response.contact);
  }
  table.contact = stacked(contact);
  if (tool.presliding_computed) {
    derive_presliding(table);
  }
  return table;
}

}  // namespace palpate

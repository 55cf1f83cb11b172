#include "precompute/build/accuracy_trade.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "formats/base/error.h"
#include "formats/database/place_check.h"
#include "formats/database/precision_choice.h"
#include "formats/database/work_unit.h"
#include "precompute/contact/indentation_response.h"
#include "precompute/press/compliance_sample.h"
#include "precompute/press/ratio_field.h"
#include "precompute/press/timed_press.h"
#include "precompute/press/work_unit_solver.h"

namespace palpate {
namespace {

// Of the database that a build would write of these responses (FORMAT.md, "Precision"):
// depths and forces as precisely as the budget needs; float64 files also keep slopes
// and energies, int16 files two scales per node. Eight numbers and two bytes per node,
// and where its samples begin.
std::int64_t stored_bytes(const std::vector<NodeResponse>& responses,
                          double force_relative) {
  ResponseDatabase database;
  database.tools.push_back(make_table({}, responses));
  const Precision precision = cheapest_precision(database, force_relative);
  const auto nodes = static_cast<std::int64_t>(responses.size());
  const auto samples = static_cast<std::int64_t>(database.tools.front().depth_m.size());
  const std::int64_t of_sample = precision == Precision::kFloat64   ? 4 * 8
                                 : precision == Precision::kFloat32 ? 2 * 4
                                                                    : 2 * 2;
  const std::int64_t of_node =
      8 * 8 + 2 + 8 + (precision == Precision::kInt16 ? 2 * 8 : 0);
  return samples * of_sample + nodes * of_node;
}

bool is_complete(const PressedNode& node) {
  return node.failure.empty() && node.indentation.sample.size() > 2;
}

std::optional<NodeResponse> response_of(const Scene& scene, const PressedNode& node) {
  if (!is_complete(node)) {
    return std::nullopt;
  }
  return to_response(node.indentation, node.path, scene.force_relative);
}

// By vertex; none where a press failed.
using Responses = std::vector<std::optional<NodeResponse>>;

Responses responses_of(const Scene& scene, const PricedPresses& presses) {
  Responses responses;
  for (const PressedNode& node : presses.node) {
    responses.push_back(response_of(scene, node));
  }
  return responses;
}

// `count` of the vertices, each the farthest from those before it.
std::vector<std::int32_t> farthest_apart(const SurfaceMesh& surface,
                                         std::span<const std::int32_t> vertices,
                                         std::size_t count) {
  std::vector<std::int32_t> chosen{vertices[vertices.size() / 2]};
  const auto distance_m = [&](std::int32_t v) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::int32_t c : chosen) {
      nearest = std::min(
          nearest, (surface.position_m.row(v) - surface.position_m.row(c)).norm());
    }
    return nearest;
  };
  while (chosen.size() < std::min(count, vertices.size())) {
    chosen.push_back(*std::max_element(vertices.begin(), vertices.end(),
                                       [&](std::int32_t a, std::int32_t b) {
                                         return distance_m(a) < distance_m(b);
                                       }));
  }
  return chosen;
}

class TradeRun {
 public:
  TradeRun(const Scene& scene, const AccuracyTradeOptions& options, Progress& progress)
      : scene_(scene), options_(options), progress_(progress) {}

  TradeReport run() {
    progress_.stage("body");
    body_ = read_body(scene_, options_.repair);
    reachable_ = reachable_vertices(scene_, body_);
    choose_vertices();
    solve_reference();
    for (const double resolution : options_.resolution) {
      press_at(resolution);
    }
    mark_pareto();
    progress_.finish();
    return std::move(report_);
  }

 private:
  [[nodiscard]] Scene scene_at(double resolution, bool nonlinear) const {
    Scene scene = scene_;
    scene.contact_resolution = resolution;
    if (!nonlinear) {
      scene.accuracy.method = "linear";
    }
    return scene;
  }

  void choose_vertices();
  void solve_reference();
  void press_at(double resolution);
  void add_interpolated(const Scene& scene, const PressStrategy& strategy,
                        const PricedPresses& linear_presses,
                        const PricedPresses& full_presses);
  void add(const AccuracyTradeRow& row, const Responses& responses);
  void mark_pareto();

  // Groups of neighbours and vertices that are solved, of all clusters.
  struct Count {
    double groups = 0.0;
    double nodes = 0.0;
  };
  [[nodiscard]] Count count(const ContactFocus& focus, bool nonlinear,
                            bool interpolated) const;
  [[nodiscard]] static double seconds(const PressPrice& price, const Count& count) {
    return price.once_s + price.per_group_s * count.groups +
           price.per_node_s * count.nodes;
  }

  const Scene& scene_;
  const AccuracyTradeOptions& options_;
  Progress& progress_;
  BodySource body_;
  std::vector<std::int32_t> reachable_;
  std::vector<std::vector<std::int32_t>> cluster_;
  Responses reference_;
  bool nonlinear_ = false;
  TradeReport report_;
};

// As close together as a build's full presses probably are, so that interpolation
// between them is what it is in a build: in parts of clusters.
void TradeRun::choose_vertices() {
  for (WorkUnit& unit : units_of(scene_, body_, reachable_)) {
    if (!unit.is_check) {
      cluster_.push_back(std::move(unit.vertex));
    }
  }
  const auto samples = static_cast<std::size_t>(options_.samples);
  // A build solves `dense` of a cluster's vertices. Samples as dense as that need so
  // many places; each takes its share from one neighbourhood of a cluster.
  const std::size_t dense =
      expected_samples(cluster_.front().size(), scene_.force_relative);
  const std::size_t places =
      std::clamp<std::size_t>((samples + dense - 1) / dense, 1, cluster_.size());
  for (std::size_t i = 0; i < places; ++i) {
    const auto& cluster = cluster_[(2 * i + 1) * cluster_.size() / (2 * places)];
    const std::size_t share = samples / places + (i < samples % places ? 1 : 0);
    const auto parts =
        in_neighbourhoods(body_.surface, cluster,
                          std::max<std::size_t>(share * cluster.size() / dense, 1));
    const auto chosen = farthest_apart(body_.surface, parts[parts.size() / 2], share);
    report_.vertex.insert(report_.vertex.end(), chosen.begin(), chosen.end());
  }
  std::sort(report_.vertex.begin(), report_.vertex.end());
  const PressStrategy strategy = choose_strategy(scene_, body_, reachable_);
  nonlinear_ = strategy.nonlinear;
  report_.reachable = static_cast<std::int64_t>(reachable_.size());
  report_.force_relative = scene_.force_relative;
  report_.budget_resolution = 2.0 / strategy.focus.growth;
  report_.notes = body_.notes;
  report_.notes.emplace_back(
      "element order is always 2: linear tets lock near incompressibility and are not "
      "offered");
  if (nonlinear_) {
    report_.notes.emplace_back(
        "interpolated: every sampled vertex from the others (leave one out), as far "
        "apart as a build's; a build goes on until that is within the budget");
  } else {
    report_.notes.emplace_back(
        "the scene is linear: nonlinear and interpolated solutions would be the same");
  }
  if (body_.tool.size() > 1) {
    report_.notes.push_back(fmt::format("of {} tools, the first was pressed: {}",
                                        body_.tool.size(), scene_.tool.front().name));
  }
}

void TradeRun::solve_reference() {
  progress_.stage("reference");
  report_.reference_resolution =
      options_.reference_finer *
      *std::max_element(options_.resolution.begin(), options_.resolution.end());
  report_.reference_depths =
      *std::max_element(options_.depths.begin(), options_.depths.end());
  Scene scene = scene_at(report_.reference_resolution, nonlinear_);
  scene.force_relative = std::min(scene.force_relative, 0.005);  // of the solvers
  const auto presses = press_on_own_meshes(
      scene, body_, contact_focus(scene, body_), report_.vertex,
      std::span(&report_.reference_depths, 1),
      {.nonlinear = nonlinear_, .recipe = {.depths = SolvedDepths::kEvery}});
  reference_ = responses_of(scene, presses.front());
  std::size_t missing = 0;
  for (std::size_t i = 0; i < reference_.size(); ++i) {
    if (!reference_[i]) {
      ++missing;
      report_.notes.push_back(fmt::format(
          "vertex {} has no reference and is left out: {}", report_.vertex[i],
          presses.front().node[i].failure.empty() ? "the tool meets nothing there"
                                                  : presses.front().node[i].failure));
    }
  }
  if (missing == reference_.size()) {
    throw NumericalError(fmt::format("none of {} sampled vertices could be solved: {}",
                                     missing, report_.notes.back()));
  }
}

TradeRun::Count TradeRun::count(const ContactFocus& focus, bool nonlinear,
                                bool interpolated) const {
  Count count;
  for (const auto& vertices : cluster_) {
    const auto solved = interpolated
                            ? expected_samples(vertices.size(), scene_.force_relative)
                            : vertices.size();
    count.nodes += static_cast<double>(solved);
    count.groups += static_cast<double>(
        group_presses(body_.surface, spread_over(vertices, solved), focus, nonlinear)
            .size());
  }
  return count;
}

void TradeRun::press_at(double resolution) {
  const auto pressed = [&](const Scene& scene, const PressStrategy& strategy,
                           bool on_shared_mesh, bool nonlinear) {
    progress_.stage(fmt::format("resolution {:.3g}, {}{}", resolution,
                                nonlinear ? "nonlinear" : "linear",
                                on_shared_mesh ? ", shared mesh" : ""));
    return on_shared_mesh
               ? press_on_shared_mesh(scene, body_, strategy, reachable_,
                                      report_.vertex, options_.depths, nonlinear)
               : press_on_own_meshes(scene, body_, strategy.focus, report_.vertex,
                                     options_.depths, {.nonlinear = nonlinear});
  };
  const auto add_all = [&](const Scene& scene, const PressStrategy& strategy,
                           const std::vector<PricedPresses>& presses, bool nonlinear) {
    for (const PricedPresses& some : presses) {
      add({.resolution = resolution,
           .nonlinear = nonlinear,
           .depths = some.depths,
           .cpu_seconds = seconds(some.price, count(strategy.focus, nonlinear, false)),
           .peak_memory_bytes = some.price.peak_memory_bytes},
          responses_of(scene, some));
    }
  };
  const Scene linear = scene_at(resolution, false);
  const PressStrategy linear_way = choose_strategy(linear, body_, reachable_);
  std::vector<PricedPresses> linear_presses =
      pressed(linear, linear_way, linear_way.shared_mesh, false);
  add_all(linear, linear_way, linear_presses, false);
  if (!nonlinear_) {
    return;
  }
  const Scene full = scene_at(resolution, true);
  const PressStrategy way = choose_strategy(full, body_, reachable_);
  const auto full_presses = pressed(full, way, way.shared_mesh && !way.graded, true);
  add_all(full, way, full_presses, true);
  // What full presses are compared with may want a finer shared mesh.
  if (way.shared_mesh != linear_way.shared_mesh ||
      (way.shared_mesh && way.subdivisions != linear_way.subdivisions)) {
    linear_presses = pressed(full, way, way.shared_mesh, false);
  }
  for (std::size_t i = 0; i < full_presses.size(); ++i) {
    add_interpolated(full, way, linear_presses[i], full_presses[i]);
  }
}

void TradeRun::add_interpolated(const Scene& scene, const PressStrategy& strategy,
                                const PricedPresses& linear_presses,
                                const PricedPresses& full_presses) {
  RatioField field(body_.surface, body_.normal, strategy.focus.contact_m);
  for (std::size_t i = 0; i < full_presses.node.size(); ++i) {
    if (is_complete(full_presses.node[i]) && is_complete(linear_presses.node[i])) {
      if (auto ratio = path_ratio(full_presses.node[i].indentation,
                                  full_presses.node[i].linear)) {
        field.add(full_presses.node[i].vertex, linear_presses.node[i].indentation,
                  std::move(*ratio));
      }
    }
  }
  // Each vertex takes the ratio that all others predict, times its own linear press.
  const RatioModel ratios(field);
  Responses responses;
  for (const PressedNode& node : linear_presses.node) {
    responses.emplace_back();
    if (is_complete(node) && field.size() > 1) {
      const Indentation path =
          scaled(node.indentation, ratios.from_others(node.vertex, node.indentation),
                 scene.reach.force_max_n);
      responses.back() = to_response(path, node.path, scene.force_relative);
    }
  }
  add({.resolution = scene.contact_resolution,
       .nonlinear = true,
       .interpolated = true,
       .depths = full_presses.depths,
       .cpu_seconds =
           seconds(linear_presses.price, count(strategy.focus, false, false)) +
           seconds(full_presses.price, count(strategy.focus, true, true)),
       .peak_memory_bytes = std::max(linear_presses.price.peak_memory_bytes,
                                     full_presses.price.peak_memory_bytes)},
      responses);
}

void TradeRun::add(const AccuracyTradeRow& row, const Responses& responses) {
  AccuracyTradeRow whole = row;
  double sum = 0.0;
  std::vector<NodeResponse> compared;
  for (std::size_t i = 0; i < responses.size(); ++i) {
    if (!responses[i] || !reference_[i]) {
      continue;
    }
    const double error = response_difference(
        *responses[i], *reference_[i], body_.normal.row(report_.vertex[i]).transpose());
    ++whole.compared;
    sum += error * error;
    compared.push_back(*responses[i]);
    whole.error_largest = std::max(whole.error_largest, error);
  }
  if (whole.compared > 0) {
    whole.error_rms = std::sqrt(sum / static_cast<double>(whole.compared));
    whole.response_bytes = stored_bytes(compared, report_.force_relative) *
                           report_.reachable / whole.compared;
  }
  report_.row.push_back(whole);
}

void TradeRun::mark_pareto() {
  for (AccuracyTradeRow& row : report_.row) {
    row.pareto =
        row.compared > 0 && std::none_of(report_.row.begin(), report_.row.end(),
                                         [&](const AccuracyTradeRow& other) {
                                           return other.compared > 0 &&
                                                  other.cpu_seconds < row.cpu_seconds &&
                                                  other.error_rms < row.error_rms;
                                         });
  }
}

}  // namespace

TradeReport trade(const Scene& scene, const AccuracyTradeOptions& options,
                  Progress& progress) {
  return TradeRun(scene, options, progress).run();
}

}  // namespace palpate

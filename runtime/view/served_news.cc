#include "runtime/view/served_news.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "formats/report/surface_map.h"
#include "formats/response/response_curve.h"
#include "runtime/view/view_curve.h"

namespace palpate {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

ServedNews::ServedNews(ServedClient& client, const GrowingElements& elements,
                       const ServedScene& scene, SceneWatch watch)
    : client_(client),
      elements_(elements),
      scene_(scene),
      watch_(std::move(watch)),
      map_depth_m_(map_depth_m(scene.plan.depth_max_m)),
      stiffness_(static_cast<std::size_t>(scene.plan.body.position_m.rows()), kNone) {}

ViewService ServedNews::service() {
  const ServiceStatus status = client_.status();
  const std::string served = client_.scene_text();
  const QualityTicks ticks = elements_.ticks();
  return {.state = std::string(name(status.state)),
          .detail = status.detail,
          .stage = status.progress.stage,
          .nodes = status.progress.nodes,
          .answered = status.progress.answered,
          .finished = status.progress.finished,
          .here = std::string(name(elements_.here())),
          .ticks = {ticks.begin(), ticks.end()},
          .changed = watch_.changed_from(served)};
}

double ServedNews::stiffness_n_per_m(std::int32_t node) const {
  const std::optional<ServedAnswer> answer = client_.answers().at(node);
  if (!answer || answer->node->response.depth_m.size() < 2) {
    return kNone;
  }
  const NodeResponse& response = answer->node->response;
  return ResponseCurve(response.depth_m, response.force_n).at(map_depth_m_).force_n /
         map_depth_m_;
}

// Stiffness of what is new, and the range of all.
void ServedNews::measure() {
  const std::vector<std::int32_t> changed = client_.answers().changed_since(measured_);
  if (changed.empty()) {
    return;
  }
  for (const std::int32_t node : changed) {
    stiffness_[static_cast<std::size_t>(node)] = stiffness_n_per_m(node);
    if (const auto answer = client_.answers().at(node);
        answer && !answer->node->response.force_n.empty()) {
      const std::vector<double>& force_n = answer->node->response.force_n;
      force_max_n_ =
          std::max(force_max_n_, *std::max_element(force_n.begin(), force_n.end()));
    }
  }
  std::vector<double> known;
  std::copy_if(stiffness_.begin(), stiffness_.end(), std::back_inserter(known),
               [](double value) {
                 return std::isfinite(value);
               });
  if (known.empty()) {
    return;
  }
  std::sort(known.begin(), known.end());
  const auto last = static_cast<double>(known.size() - 1);
  low_n_per_m_ = known[static_cast<std::size_t>(std::lround(0.02 * last))];
  high_n_per_m_ = known[static_cast<std::size_t>(std::lround(0.98 * last))];
  const double least = std::max(0.1 * high_n_per_m_, 1e-9);  // no rounding as colours
  const double missing = least - (high_n_per_m_ - low_n_per_m_);
  if (missing > 0.0) {
    low_n_per_m_ -= missing / 2.0;
    high_n_per_m_ += missing / 2.0;
  }
}

std::optional<std::string> ServedNews::answers(ViewClient page, std::int64_t now_ns) {
  Page& at = page_[page];
  if (now_ns - at.sent_ns < kBatchNs) {
    return std::nullopt;
  }
  if (at.waiting.empty()) {
    at.waiting = client_.answers().changed_since(at.changes);
    std::reverse(at.waiting.begin(), at.waiting.end());
  }
  if (at.waiting.empty()) {
    return std::nullopt;
  }
  at.sent_ns = now_ns;
  measure();
  nlohmann::json json{{"type", "answers"},
                      {"node", nlohmann::json::array()},
                      {"stiffness", nlohmann::json::array()},
                      {"final", nlohmann::json::array()},
                      {"low_n_per_m", low_n_per_m_},
                      {"high_n_per_m", high_n_per_m_},
                      {"force_max_n", force_max_n_}};
  for (std::size_t i = 0; i < kBatch && !at.waiting.empty(); ++i) {
    const std::int32_t node = at.waiting.back();
    at.waiting.pop_back();
    const std::optional<ServedAnswer> answer = client_.answers().at(node);
    const double stiffness = stiffness_[static_cast<std::size_t>(node)];
    json["node"].push_back(node);
    json["stiffness"].push_back(std::isfinite(stiffness)
                                    ? nlohmann::json(static_cast<float>(stiffness))
                                    : nlohmann::json());
    json["final"].push_back(answer && answer->quality == AnswerQuality::kFinal ? 1 : 0);
  }
  return json_text(json);
}

std::string ServedNews::curve(std::int32_t node) const {
  const JobDescription& plan = scene_.plan;
  const auto nodes = static_cast<std::size_t>(plan.body.position_m.rows());
  std::vector<NodeResponse> responses(nodes);
  if (const auto answer = client_.answers().at(node)) {
    responses[static_cast<std::size_t>(node)] = answer->node->response;
  }
  ResponseDatabase database;
  database.body = plan.body;
  database.normal = plan.normal;
  return curve_text(
      database,
      make_table(plan.tool[static_cast<std::size_t>(client_.tool())], responses), node);
}

}  // namespace palpate

#include "formats/service/service_message.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/database/database_rules.h"
#include "formats/database/work_unit_cbor.h"
#include "formats/response/response_rules.h"

namespace palpate {
namespace {

using nlohmann::json;

constexpr std::array<std::byte, 4> kFrameMagic{std::byte{'P'}, std::byte{'L'},
                                               std::byte{'P'}, std::byte{'S'}};
constexpr std::size_t kHead = 8;

Eigen::Vector3d finite_vector(const json& j) {
  const auto v = j.get<std::array<double, 3>>();
  const Eigen::Vector3d vector(v[0], v[1], v[2]);
  if (!vector.allFinite()) {
    throw FormatError("a vector is not finite");
  }
  return vector;
}

void write(json& j, const ServedScene& scene) {
  j = {{"kind", "scene"},
       {"plan", scene.plan},
       {"reachable", scene.reachable},
       {"output", scene.output},
       {"nonlinear", scene.nonlinear},
       {"modulus_pa", scene.modulus_pa}};
}

void write(json& j, const ServedResponses& responses) {
  // The list of nodes as it stands in a unit of work.
  json unit = WorkUnitOutcome{.index = 0, .is_check = false, .node = responses.node};
  j = {{"kind", "responses"},
       {"quality", static_cast<int>(responses.quality)},
       {"node", std::move(unit["node"])}};
}

void write(json& j, const ServedProgress& progress) {
  j = {{"kind", "progress"},
       {"stage", progress.stage},
       {"nodes", progress.nodes},
       {"answered", progress.answered},
       {"finished", progress.finished}};
}

void write(json& j, const ServedEnd& end) {
  j = {{"kind", "end"}, {"file", end.file}, {"failure", end.failure}};
}

void write(json& j, const HandPlace& hand) {
  j = {{"kind", "hand"},
       {"tool", hand.tool},
       {"position_m", json_list(hand.position_m)},
       {"velocity_m_per_s", json_list(hand.velocity_m_per_s)},
       {"touches", hand.touches}};
}

void check_plan(const JobDescription& plan) {
  const auto n = plan.body.position_m.rows();
  if (n == 0 || plan.tool.empty() || plan.body.triangle.rows() == 0) {
    throw FormatError("the body has no vertices, triangles or tools");
  }
  check_nodes(plan.body.position_m, plan.normal);
  check_triangles(plan.body.triangle, n);
  for (const ToolShape& tool : plan.tool) {
    check(tool);
  }
  for (const double number : {plan.force_relative, plan.depth_max_m}) {
    if (!(number >= 0.0) || !std::isfinite(number)) {
      throw FormatError(fmt::format(
          "force_relative or depth_max_m is {}, must be finite and not negative",
          number));
    }
  }
  if (!(plan.force_max_n >= 0.0)) {  // infinite where the scene has none
    throw FormatError(
        fmt::format("force_max_n is {}, must not be negative", plan.force_max_n));
  }
}

ServedScene scene_of(const json& j) {
  ServedScene scene{.plan = {},
                    .reachable = j.at("reachable"),
                    .output = j.at("output"),
                    .nonlinear = j.at("nonlinear"),
                    .modulus_pa = j.value("modulus_pa", 0.0)};
  if (!(scene.modulus_pa >= 0.0) || !std::isfinite(scene.modulus_pa)) {
    throw FormatError(fmt::format("modulus_pa is {}, must be finite and not negative",
                                  scene.modulus_pa));
  }
  from_json(j.at("plan"), scene.plan);
  check_plan(scene.plan);
  const auto n = scene.plan.body.position_m.rows();
  const bool ascending = std::is_sorted(scene.reachable.begin(), scene.reachable.end(),
                                        std::less_equal<>());
  if (!ascending || (!scene.reachable.empty() &&
                     (scene.reachable.front() < 0 || scene.reachable.back() >= n))) {
    throw FormatError("reachable vertices are not ascending vertices of the body");
  }
  return scene;
}

ServedResponses responses_of(const json& j) {
  const int quality = j.at("quality");
  if (quality != 0 && quality != 1) {
    throw FormatError(fmt::format("quality is {}, must be 0 or 1", quality));
  }
  WorkUnitOutcome unit;
  from_json(json{{"index", 0}, {"is_check", false}, {"node", j.at("node")}}, unit);
  for (const WorkUnitNode& node : unit.node) {
    const std::string broken = broken_rule(node.response);
    if (node.vertex < 0 || node.tool < 0 || !broken.empty()) {
      throw FormatError(fmt::format("vertex {}, tool {}: {}", node.vertex, node.tool,
                                    broken.empty() ? "not an index" : broken));
    }
  }
  return {static_cast<AnswerQuality>(quality), std::move(unit.node)};
}

ServedProgress progress_of(const json& j) {
  return {.stage = j.at("stage"),
          .nodes = j.at("nodes"),
          .answered = j.at("answered"),
          .finished = j.at("finished")};
}

HandPlace hand_of(const json& j) {
  HandPlace hand{.tool = j.at("tool"),
                 .position_m = finite_vector(j.at("position_m")),
                 .velocity_m_per_s = finite_vector(j.at("velocity_m_per_s")),
                 .touches = j.at("touches")};
  if (hand.tool < 0) {
    throw FormatError(fmt::format("tool {} is not an index", hand.tool));
  }
  return hand;
}

// Refuses what is nested so deeply that reading it would end the stack, and so many
// values that they would fill the memory: each takes one byte or more here, 16 there.
struct SizeCheck : nlohmann::json_sax<json> {
  static constexpr int kDeepest = 16;
  static constexpr std::size_t kMostValues = std::size_t{1} << 27;
  int depth = 0;
  std::size_t values = 0;

  bool one() { return ++values <= kMostValues; }
  bool null() override { return one(); }
  bool boolean(bool /*value*/) override { return one(); }
  bool number_integer(number_integer_t /*value*/) override { return one(); }
  bool number_unsigned(number_unsigned_t /*value*/) override { return one(); }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override {
    return one();
  }
  bool string(string_t& /*value*/) override { return one(); }
  bool binary(binary_t& /*value*/) override { return one(); }
  bool start_object(std::size_t /*elements*/) override {
    return one() && ++depth <= kDeepest;
  }
  bool key(string_t& /*value*/) override { return true; }
  bool end_object() override { return --depth >= 0; }
  bool start_array(std::size_t /*elements*/) override {
    return one() && ++depth <= kDeepest;
  }
  bool end_array() override { return --depth >= 0; }
  bool parse_error(std::size_t /*position*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    throw FormatError(error.what());
  }
};

ServiceMessage message_of(const json& j) {
  const int version = j.at("version");
  if (version != kServiceVersion) {
    throw FormatError(
        fmt::format("version is {}, known is {}: both sides must be of "
                    "one palpate",
                    version, kServiceVersion));
  }
  const std::string kind = j.at("kind");
  if (kind == "scene") {
    return scene_of(j);
  }
  if (kind == "responses") {
    return responses_of(j);
  }
  if (kind == "progress") {
    return progress_of(j);
  }
  if (kind == "end") {
    return ServedEnd{.file = j.at("file"), .failure = j.at("failure")};
  }
  if (kind == "hand") {
    return hand_of(j);
  }
  throw FormatError(fmt::format("kind '{}' is not known", kind.substr(0, 40)));
}

}  // namespace

std::vector<std::byte> to_frame(const ServiceMessage& message) {
  json j;
  std::visit(
      [&](const auto& m) {
        write(j, m);
      },
      message);
  j["version"] = kServiceVersion;
  const std::vector<std::uint8_t> body = json::to_cbor(j);
  // Magic, bytes of the body (uint32, little-endian), the body in CBOR.
  std::vector<std::byte> frame(kFrameMagic.begin(), kFrameMagic.end());
  frame.reserve(kHead + body.size());
  for (int i = 0; i < 4; ++i) {
    frame.push_back(static_cast<std::byte>((body.size() >> (8 * i)) & 0xff));
  }
  const auto bytes = std::as_bytes(std::span(body));
  frame.insert(frame.end(), bytes.begin(), bytes.end());
  return frame;
}

ServiceMessage message_from_bytes(std::span<const std::byte> body) {
  const auto* first = reinterpret_cast<const std::uint8_t*>(body.data());
  try {
    SizeCheck size;
    if (!json::sax_parse(first, first + body.size(), &size,
                         json::input_format_t::cbor)) {
      throw FormatError(
          fmt::format("nested more than {} deep, or of more than {} values",
                      SizeCheck::kDeepest, SizeCheck::kMostValues));
    }
    return message_of(json::from_cbor(first, first + body.size()));
  } catch (const json::exception& error) {
    throw FormatError(fmt::format("a message of the service: {}", error.what()));
  } catch (const Error& error) {
    throw FormatError(fmt::format("a message of the service: {}", error.what()));
  }
}

void FrameReader::take(std::span<const std::byte> bytes) {
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  const std::size_t begun = std::min(waiting_.size(), kFrameMagic.size());
  if (!std::equal(waiting_.begin(),
                  waiting_.begin() + static_cast<std::ptrdiff_t>(begun),
                  kFrameMagic.begin())) {
    throw FormatError("what came over the socket is not of a palpate service");
  }
  if (waiting_.size() >= kHead && length() > kServiceFrameMax) {
    throw FormatError(fmt::format("a message of {} bytes, at most {} are allowed",
                                  length(), kServiceFrameMax));
  }
}

std::size_t FrameReader::length() const {
  std::size_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    length |= std::to_integer<std::size_t>(waiting_[4 + i]) << (8 * i);
  }
  return length;
}

std::vector<std::byte> FrameReader::next() {
  if (waiting_.size() < kHead || waiting_.size() < kHead + length()) {
    return {};
  }
  const auto body = waiting_.begin() + kHead;
  const auto end = body + static_cast<std::ptrdiff_t>(length());
  std::vector<std::byte> frame(body, end);
  waiting_.erase(waiting_.begin(), end);
  take({});  // what follows must be a frame, too
  return frame;
}

}  // namespace palpate

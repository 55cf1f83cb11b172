// An answer of a service as what the slow process sends of a node.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include <Eigen/Core>

#include "formats/response/tool_shape.h"
#include "formats/service/service_message.h"
#include "runtime/element/element.h"

namespace palpate {

/// What a place of the body answers with.
enum class GrownQuality : std::uint8_t {
  kNone = 0,
  kEstimated = 1,  ///< stiffness_estimate.h
  kPreliminary = 2,
  kFinal = 3,
};
constexpr std::size_t kGrownQualities = 4;

/// "none", "estimated", "preliminary", "final".
[[nodiscard]] std::string_view name(GrownQuality quality) noexcept;

[[nodiscard]] constexpr GrownQuality grown(AnswerQuality quality) noexcept {
  return quality == AnswerQuality::kFinal ? GrownQuality::kFinal
                                          : GrownQuality::kPreliminary;
}

/// A node's answer, ready to be sent.
struct GrownNode {
  std::int32_t node = -1;
  GrownQuality quality = GrownQuality::kNone;
  ElementNode message;  ///< without samples: the answer is that there is no response
};

/// [N/m] the most that the message can make a tool feel: its steepest slope, or its
/// friction's spring at its largest force; 0 without samples.
[[nodiscard]] double stiffness_n_per_m(const ElementNode& node);

/// The answer of a node as a message. A response whose direction does not point out of
/// the body (n . u < 0.05) is none, and so is one that breaks a rule.
/// @param normal [-] outward, of the node.
/// @param longest_edge_m [m] at the node, which limits its tilt; 0: it does not.
[[nodiscard]] GrownNode grown_node(const ToolShape& tool, const WorkUnitNode& answer,
                                   GrownQuality quality,
                                   const Eigen::Vector3d& position_m,
                                   const Eigen::Vector3d& normal,
                                   double longest_edge_m = 0.0);

/// Makes a node's forces as much softer as its steepest slope needs, and lets friction
/// slide in later where its spring would be too stiff. @returns the factor [-] (0, 1]
double soften(ElementNode& node, double stiffness_max_n_per_m);

}  // namespace palpate

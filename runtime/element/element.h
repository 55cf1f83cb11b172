// One surface element with its three responses, whole and flat: what the slow process
// sends to the fast one (paper, 5.2.2).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <Eigen/Core>

#include "formats/response/contact_depths.h"
#include "formats/response/curve_view.h"
#include "runtime/account/real.h"

namespace palpate {

/// Samples that one curve of an element message can hold; the sender resamples longer
/// curves, so that a message has a fixed size.
constexpr std::size_t kElementSamples = 48;

/// Most elements that one tick takes in, of all contacts. An element takes a few
/// microseconds, so a leap of many contacts does not make a tick late.
constexpr int kElementsATick = 64;

using ElementSample = BasicResponseSample<Real>;
using ElementCurve = BasicCurveView<Real>;

constexpr std::size_t kMemoryTerms = 4;    ///< relaxation times of a tool, at most
constexpr std::size_t kNodeSites = 4;      ///< memory sites that a node reads, at most
constexpr std::size_t kMemoryBundles = 8;  ///< parts that a curve is cut into, at most

/// Where one node's memory lies on the surface, and how much of its force relaxes.
struct NodeMemory {
  std::array<std::int32_t, kNodeSites> site{-1, -1, -1, -1};  ///< -1: none
  std::array<Real, kNodeSites> weight{};      ///< [-] >= 0 of each site; sum at most 1
  std::array<Real, kMemoryTerms> relaxing{};  ///< [-] g_k >= 0, sum at most 1
  /// [m] where its curve is cut; bundle b reaches from cut b - 1 to cut b, the first
  /// from 0, the last to infinity. Not decreasing; only of an element with bundles.
  std::array<Real, kMemoryBundles - 1> cut_m{};
  // Dents that stay and curves that soften (yielding_place.h).
  Real yield_depth_m = 0.0;  ///< [m] >= 0 d_y along the direction: past it dents stay
  Real dent_share = 0.0;     ///< [-] [0, 1) r of what is past it; 0: none
  Real onset_m = 0.0;        ///< [m] >= 0 m_0 past which the curve softens
  Real soft_scale_m = 1.0;   ///< [m] > 0 m_1
  /// [-] [0, 1) omega_max; 0: it does not. Else the curve is the undamaged one,
  /// f / (1 - omega) of the response f to a first press.
  Real soft_most = 0.0;
};

constexpr int kPunctureMaterials = 8;       ///< that a tool may cut, at most
constexpr std::size_t kPunctureLayers = 6;  ///< along a node's axis, at most

/// What a needle meets below a node (needle/channel.h).
struct NodePuncture {
  std::int32_t layers = 0;  ///< [0, kPunctureLayers]; 0: nothing is punctured here
  Real rupture = 0.0;       ///< [N] or [J] >= 0 that breaks the first membrane
  /// [m] along the axis where a layer begins: the first at 0, increasing.
  std::array<Real, kPunctureLayers> depth_m{};
  std::array<std::int8_t, kPunctureLayers> material{};  ///< of the tool's rules
};

/// How an element's responses relax while a tool presses (relaxing_contact.h), and
/// whether they yield.
struct ElementMemory {
  std::int32_t terms = 0;    ///< [0, kMemoryTerms]; 0: responses are static
  std::int32_t bundles = 1;  ///< [1, kMemoryBundles]
  std::array<Real, kMemoryTerms> relaxation_s{};  ///< [s] tau_k > 0, increasing
  bool yields = false;  ///< some node of the tool leaves dents or softens
  std::array<NodeMemory, 3> node{};
};

/// One node's response inside an element message.
struct ElementNode {
  std::int32_t node = -1;    ///< index in the database; equal in neighbouring elements
  std::int32_t samples = 0;  ///< [0, kElementSamples]; 0: no response here
  std::array<Real, 3> position_m{};  ///< [m] world frame
  std::array<Real, 3> normal{};      ///< [-] outward unit normal of the body
  std::array<Real, 3> direction{};  ///< [-] unit, force on the tool; 0 without response
  /// [-] tangential force over the normal one, along the surface, with the tool at
  /// height 0 on the node's line. Also its change with the height [1/m]. At the heights
  /// of the curve's depths the tilt's length is at most 1. (smooth_triangle.h)
  std::array<Real, 3> tilt{};
  std::array<Real, 3> tilt_by_height_per_m{};
  Real touch_offset_m = 0.0;  ///< [m] normal penetration at first touch
  Real friction = 0.0;        ///< [-] [0, 10]
  Real presliding_m = 0.0;    ///< [m] delta_L
  /// [-] S of contact_table.h, (xx, xy, yy) at each of kContactDepthShares of the last
  /// depth, in the node's tangent frame; 0: the presliding length tells all.
  std::array<Real, 3 * kContactDepths> lateral{};
  std::array<Real, kElementSamples> depth_m{};
  std::array<Real, kElementSamples> force_n{};
  std::array<Real, kElementSamples> stiffness_n_per_m{};
  std::array<Real, kElementSamples> energy_j{};

  [[nodiscard]] ElementCurve curve() const noexcept {
    const auto n = static_cast<std::size_t>(samples);
    return {{depth_m.data(), n},
            {force_n.data(), n},
            {stiffness_n_per_m.data(), n},
            {energy_j.data(), n}};
  }
};

/// A triangle of the surface. Messages are copied whole through the FIFO.
struct Element {
  std::int32_t triangle = -1;       ///< index in the database; -1: no element
  std::uint64_t sequence = 0;       ///< counts up from 1 as the slow process sends
  std::int64_t sent_ns = 0;         ///< [ns] monotonic clock
  bool active = false;              ///< nearest to the tool when sent, else a neighbour
  Real touch_height_m = 0.0;        ///< [m] >= 0 of the tool over the surface at touch
  std::array<ElementNode, 3> node;  ///< counter-clockwise from outside
  /// Triangle across edge (j, j+1); -1 at a border.
  std::array<std::int32_t, 3> neighbour{-1, -1, -1};
  ElementMemory memory;
  std::array<NodePuncture, 3> puncture{};
};

static_assert(std::is_trivially_copyable_v<Element>);

}  // namespace palpate

// How a tool's responses relax while it presses, as it is rendered: quasi-linear
// viscoelasticity (Fung) with times that are common to the tool.
//
//   F(t) = integral of G(t - t') df(d(t')),   G(t) = 1 - sum g_k (1 - exp(-t / tau_k)),
//
// f the instantaneous response of a node. What was pressed is remembered at sites on
// the surface, coarser than the mesh: a contact that slides leaves its dent behind.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace palpate {

constexpr std::int64_t kMostTerms = 4;      ///< relaxation times of a tool
constexpr std::int64_t kMostNodeSites = 4;  ///< memory sites that a node reads
constexpr std::int64_t kMostBundles = 8;    ///< parts that a curve is cut into

template <typename T>
using RowsOf = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Places of the surface that remember, and which of them every node reads.
struct MemorySites {
  double spacing_m = 0.0;               ///< [m] > 0 between neighbouring sites
  std::vector<std::int32_t> node = {};  ///< (m) at the site; -1: not in this file
  RowsOf<std::int32_t> site = {};       ///< (n x 4) rows of `node`; -1: none
  RowsOf<float> weight = {};            ///< (n x 4) [-] >= 0; sum 1, or no site

  [[nodiscard]] bool empty() const noexcept { return site.rows() == 0; }
};

/// How responses yield for good (yielding.h): a row for all nodes alike, or (n).
struct Yielding {
  // Dents stay past a depth, so much of what is past it; no share: none do.
  std::vector<double> yield_depth_m = {};  ///< [m] >= 0
  std::vector<double> share = {};          ///< [-] [0, 1)
  // Curves soften past a depth, over the scale, by at most `largest`; none: not at all.
  std::vector<double> onset_m = {};  ///< [m] >= 0
  std::vector<double> scale_m = {};  ///< [m] > 0
  std::vector<double> largest = {};  ///< [-] [0, 1)

  [[nodiscard]] bool empty() const noexcept { return share.empty() && largest.empty(); }
};

/// A node's value of one of these. @param rows one for all nodes alike, or (n).
[[nodiscard]] inline double row_of(const std::vector<double>& rows,
                                   std::int64_t node) noexcept {
  return rows[rows.size() == 1 ? 0 : static_cast<std::size_t>(node)];
}

/// Calls with(name, units, rows) for every dataset of it, names relative to the tool's
/// group: the one place where they stand.
template <typename Rows, typename With>
void for_each_dataset(Rows& yielding, const With& with) {
  with("/plastic/yield_depth_m", "m", yielding.yield_depth_m);
  with("/plastic/share", "1", yielding.share);
  with("/damage/onset_m", "m", yielding.onset_m);
  with("/damage/scale_m", "m", yielding.scale_m);
  with("/damage/largest", "1", yielding.largest);
}

/// Of a tool's responses: how they relax, without times not at all, and how they yield.
struct Viscoelasticity {
  std::string rule = {};           ///< how the shares were found; one line
  std::int64_t probes = 0;         ///< indentations behind them; 0: from materials
  bool instantaneous = false;      ///< curves are f; else of a press at speed_m_per_s
  double speed_m_per_s = 0.0;      ///< [m/s] > 0 unless instantaneous
  std::vector<double> tau_s = {};  ///< (K) [s] > 0, increasing; K at most kMostTerms
  RowsOf<float> g = {};            ///< (1 or n x K) [-] >= 0, row sums at most 1
  /// (1 or n) over the force at the start: rms of the fit. Of measured fields the error
  /// is the standard deviation of the force that is gone while held. Empty: not known.
  std::vector<float> error_relative = {};
  MemorySites sites = {};                   ///< empty: every node is a site
  std::vector<double> bundle_depth_m = {};  ///< [m] cuts of every curve; none: one part
  Yielding yielding = {};

  /// Nothing relaxes.
  [[nodiscard]] bool empty() const noexcept { return tau_s.empty(); }
  /// Something stays of a press, for a while or for good.
  [[nodiscard]] bool remembers() const noexcept {
    return !empty() || !yielding.empty();
  }
  [[nodiscard]] std::int64_t terms() const noexcept {
    return static_cast<std::int64_t>(tau_s.size());
  }
  [[nodiscard]] std::int64_t bundles() const noexcept {
    return static_cast<std::int64_t>(bundle_depth_m.size()) + 1;
  }
  /// g_k of a node, (K).
  [[nodiscard]] Eigen::RowVectorXd shares(std::int64_t node) const {
    return g.row(g.rows() == 1 ? 0 : node).cast<double>();
  }
};

/// G(t) of a node. @param time_s [s] >= 0
[[nodiscard]] double relaxed_share(const Viscoelasticity& relaxation, std::int64_t node,
                                   double time_s);

/// G at infinite time.
[[nodiscard]] double slow_share(const Viscoelasticity& relaxation, std::int64_t node);

/// Mean time of what relaxes at a node, by share: sum g_k tau_k / sum g_k [s]; 0 where
/// nothing does.
[[nodiscard]] double mean_time_s(const Viscoelasticity& relaxation, std::int64_t node);

/// The smallest and the largest of several nodes: g_1 .. g_K, and their sum.
struct ShareExtent {
  Eigen::RowVectorXd low;   ///< (K + 1) [-]
  Eigen::RowVectorXd high;  ///< (K + 1) [-]
};

/// @param relaxation with at least one row of shares.
[[nodiscard]] ShareExtent share_extent(const Viscoelasticity& relaxation);

/// One line for people: what stays of a force that is held, and how fast.
/// @param relaxation not empty; its shares are not read.
[[nodiscard]] std::string describe(const Viscoelasticity& relaxation,
                                   const ShareExtent& shares);

/// One line for people: where the surface remembers. @param sites that there are.
[[nodiscard]] std::string describe_memory(const Viscoelasticity& relaxation,
                                          std::int64_t sites);

}  // namespace palpate

// How the force falls while the tool stays where it is: two terms of Prony's series.
//
//   F(t) = F(0) phi(t),  phi(t) = 1 - g_1 (1 - exp(-t / tau_1)) - g_2 (1 - exp(-t /
//   tau_2)),  t [s] from the end of the press.
//
// A response's curve holds for a press at about `speed_m_per_s`; in the limit of slow
// pressing it is (1 - g_1 - g_2) times as high.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

/// Terms of several places: as many rows in all four, rows not a number where unknown.
struct PronyTerms {
  std::vector<double> g_1 = {};      ///< [-] >= 0, g_1 + g_2 <= 1
  std::vector<double> g_2 = {};      ///< [-] >= 0
  std::vector<double> tau_1_s = {};  ///< [s] > 0
  std::vector<double> tau_2_s = {};  ///< [s] >= tau_1_s

  [[nodiscard]] std::size_t size() const noexcept { return g_1.size(); }
};

/// phi(t) of one row. @param time_s [s] >= 0
[[nodiscard]] double relaxed_share(const PronyTerms& terms, std::size_t row,
                                   double time_s) noexcept;

/// Of a tool's responses; without rows where nothing is known.
struct ResponseRelaxation {
  std::string rule = {};       ///< how the rows follow from the probes; one line
  std::int64_t probes = 0;     ///< behind the rows, at least 1
  double speed_m_per_s = 0.0;  ///< [m/s] > 0 of the press for which the curves hold
  double seconds = 0.0;        ///< [s] > 0 length of the holds: the terms' domain
  PronyTerms terms = {};       ///< (1) for all nodes alike, or (n)

  [[nodiscard]] bool empty() const noexcept { return terms.size() == 0; }

  /// The row of a node.
  [[nodiscard]] std::size_t row_of(std::size_t node) const noexcept {
    return terms.size() == 1 ? 0 : node;
  }
};

/// One line for people: what stays after the holds, terms, speed, rule. Several rows as
/// their smallest and largest. @param relaxation not empty.
[[nodiscard]] std::string describe(const ResponseRelaxation& relaxation);

/// Of the runs of a measurement, each by itself; rows not a number where a run has no
/// hold or its fit was refused. Without rows where no run has any.
struct RunRelaxation {
  PronyTerms terms = {};                   ///< (r)
  std::vector<double> speed_m_per_s = {};  ///< (r) [m/s] of the press before the hold
  std::vector<double> seconds = {};        ///< (r) [s] length of the hold
  std::vector<double> rms_relative = {};   ///< (r) [-] of the residuals, over F(0)
};

}  // namespace palpate

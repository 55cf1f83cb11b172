// The depths at which a contact's pressure and lateral stiffness are stored
// (contact_table.h). Header only, for the fast step too.
#pragma once

#include <array>
#include <cstddef>

namespace palpate {

inline constexpr std::size_t kContactDepths = 4;
/// [-] of a curve's last depth: evenly spaced in the radius of a ball's contact.
inline constexpr std::array<double, kContactDepths> kContactDepthShares{
    1.0 / 16.0, 1.0 / 4.0, 9.0 / 16.0, 1.0};

/// Where a share lies: between the stored depths `knot` and `knot` + 1, `part` of the
/// way. Shares before the first and after the last count as those.
template <typename Real>
struct BetweenDepths {
  std::size_t knot = 0;
  Real part = 0;

  [[nodiscard]] static BetweenDepths at(Real share) noexcept {
    std::size_t k = 0;
    while (k + 2 < kContactDepths &&
           !(share < static_cast<Real>(kContactDepthShares[k + 1]))) {
      ++k;
    }
    const auto low = static_cast<Real>(kContactDepthShares[k]);
    const auto high = static_cast<Real>(kContactDepthShares[k + 1]);
    const Real part = (share - low) / (high - low);
    return {k, part > Real(0) ? (part < Real(1) ? part : Real(1)) : Real(0)};
  }

  /// Between numbers of all depths, `columns` of each. @param row as std::array has it.
  template <typename Row>
  [[nodiscard]] Real of(const Row& row, std::size_t columns,
                        std::size_t column) const noexcept {
    const auto low = static_cast<Real>(row[knot * columns + column]);
    const auto high = static_cast<Real>(row[(knot + 1) * columns + column]);
    return low + part * (high - low);
  }
};

}  // namespace palpate

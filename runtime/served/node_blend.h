// A node's response on its way from one curve to a better one, in steps that a hand
// does not feel as a jump.
//
// Two responses of a node differ in direction, first touch, depth and force. At equal
// place of the tool they are compared by what they answer with along the outward normal
// n at its penetration delta. That is g(delta) = c f(c (delta - t)), with c = |n . u|
// and touch offset t. Their energies as functions of delta are those of g. On the way,
// g and with it the energy is (1 - s) times the old one plus s times the new one. Both
// are cubics between common knots. So the sum is a cubic, too, and E' = g holds to
// rounding. A response that is missing is g = 0.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "runtime/element/element.h"

namespace palpate {

/// Largest g of a message [N] up to its last sample; 0 without samples.
[[nodiscard]] double largest_normal_force_n(const ElementNode& node) noexcept;

/// From one message of a node to another one; both with the same place and normal.
class NodeBlend {
 public:
  /// @param reach_m [m] > 0: energies divided by it are forces along the surface, which
  /// change with them; the height of the node's flattest triangle.
  NodeBlend(const ElementNode& from, const ElementNode& to, double reach_m);

  /// Goes on by one step; the last step arrives. Up to the deeper curve's last sample a
  /// step changes no g by more than most_n / sqrt 2. The step changes no energy over
  /// reach_m by more than most_n / sqrt 8. The force of the potential field is
  /// F = -grad sum n_j E_j. The force then changes by at most most_n [N] >= 0 while all
  /// three nodes of its element step so. Along the normal it changes by sum n_j g_j.
  /// Along the surface it changes by sum E_j grad n_j with |grad n_j| at most
  /// 1 / reach_m. The gradients have three directions, of which two can add up. (Of
  /// slivers three add up: 1.3 most_n; prisms narrow with depth: 1.1.)
  /// @returns the message now.
  const ElementNode& step(double most_n);

  [[nodiscard]] bool arrived() const noexcept { return share_ >= 1.0; }

  /// [-] [0, 1] s.
  [[nodiscard]] double share() const noexcept { return share_; }

  /// [N] largest g of both ends.
  [[nodiscard]] double largest_n() const noexcept { return largest_n_; }

 private:
  struct Knot {
    double penetration_m = 0.0;
    std::array<double, 2> force_n{};            // g of either end
    std::array<double, 2> stiffness_n_per_m{};  // g'
  };

  void choose_knots();
  void measure(double reach_m);
  void set_now();

  ElementNode from_;
  ElementNode to_;
  ElementNode now_;
  std::array<Knot, kElementSamples> knot_;
  std::size_t knots_ = 0;
  double largest_n_ = 0.0;
  double change_n_ = 0.0;  // from s = 0 to 1
  double share_ = 0.0;
};

}  // namespace palpate

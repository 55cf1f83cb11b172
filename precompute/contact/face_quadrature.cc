#include "precompute/contact/face_quadrature.h"

namespace palpate {
namespace {

using Bary = Eigen::Vector3d;

// Barycentric coordinates of the six nodes of a face.
Bary face_node(int j) {
  return j < 3 ? Bary(Bary::Unit(j))
               : Bary(0.5 * (Bary::Unit(j - 3) + Bary::Unit((j - 2) % 3)));
}

struct RulePoint {
  Bary at;
  double weight;
};

std::array<RulePoint, 6> triangle_rule() {
  // Six points, exact for polynomials of degree 4 (Strang, Fix 1973). Weights sum to 1.
  constexpr double kA = 0.445948490915965;
  constexpr double kB = 0.091576213509771;
  constexpr double kWeightA = 0.223381589678011;
  constexpr double kWeightB = 0.109951743655322;
  const auto point = [](double c, int apex, double weight) {
    Bary at = Bary::Constant(c);
    at[apex] = 1.0 - 2.0 * c;
    return RulePoint{at, weight};
  };
  return {point(kA, 0, kWeightA), point(kA, 1, kWeightA), point(kA, 2, kWeightA),
          point(kB, 0, kWeightB), point(kB, 1, kWeightB), point(kB, 2, kWeightB)};
}

Eigen::Matrix<double, 6, 1> quadratic_shape(const Bary& L) {
  Eigen::Matrix<double, 6, 1> N;
  N << L[0] * (2 * L[0] - 1), L[1] * (2 * L[1] - 1), L[2] * (2 * L[2] - 1),
      4 * L[0] * L[1], 4 * L[1] * L[2], 4 * L[2] * L[0];
  return N;
}

std::vector<FaceRulePoint> make_rule() {
  std::vector<FaceRulePoint> points;
  // The rule on each of the four sub-triangles: a hat is linear there.
  for (const auto& sub : kSubTriangle) {
    for (const RulePoint& rule : triangle_rule()) {
      FaceRulePoint point;
      point.at.setZero();
      point.hat.setZero();
      for (int k = 0; k < 3; ++k) {
        const int node = sub[static_cast<std::size_t>(k)];
        point.at += rule.at[k] * face_node(node);
        point.hat[node] = rule.at[k];
      }
      point.area_share = rule.weight / 4.0;
      point.shape = quadratic_shape(point.at);
      points.push_back(point);
    }
  }
  return points;
}

}  // namespace

const std::vector<FaceRulePoint>& face_rule() {
  static const std::vector<FaceRulePoint> rule = make_rule();
  return rule;
}

}  // namespace palpate

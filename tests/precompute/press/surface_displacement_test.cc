#include "precompute/press/surface_displacement.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace {

PressFields pressed(const Eigen::MatrixXd& field_m) {
  PressFields fields;
  fields.field_m = field_m;
  for (Eigen::Index j = 0; j < field_m.cols(); ++j) {
    fields.node.push_back(static_cast<std::int32_t>(j));
    fields.depth_m.push_back(0.001 * static_cast<double>(j + 1));
  }
  return fields;
}

// Smooth bumps along a line of 200 vertices.
Eigen::MatrixXd bumps(Eigen::Index count) {
  Eigen::MatrixXd field = Eigen::MatrixXd::Zero(600, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double middle = 40.0 + 3.0 * static_cast<double>(k);
    for (Eigen::Index v = 0; v < 200; ++v) {
      const double x = (static_cast<double>(v) - middle) / 25.0;
      field(3 * v + 2, k) = -0.002 * static_cast<double>(k + 1) * std::exp(-x * x);
      field(3 * v, k) = 0.3 * x * field(3 * v + 2, k);
    }
  }
  return field;
}

double worst(const Eigen::MatrixXd& field, const DisplacementField& stored) {
  const Eigen::MatrixXd missed =
      field -
      stored.basis.cast<double>() * stored.coefficient.cast<double>().transpose();
  double largest = 0.0;
  for (Eigen::Index k = 0; k < field.cols(); ++k) {
    double miss_m = 0.0;
    double most_m = 0.0;
    for (Eigen::Index v = 0; v < field.rows() / 3; ++v) {
      miss_m = std::max(miss_m, missed.col(k).segment<3>(3 * v).norm());
      most_m = std::max(most_m, field.col(k).segment<3>(3 * v).norm());
    }
    largest = std::max(largest, miss_m / most_m);
  }
  return largest;
}

TEST(SurfaceField, NoVertexIsOffByMoreThanAskedFor) {
  const Eigen::MatrixXd field = bumps(40);
  Eigen::Index modes = 0;
  for (const double error : {0.2, 0.02, 0.002}) {
    const DisplacementField stored = compress_fields(pressed(field), error);
    EXPECT_LE(worst(field, stored), error * 1.001);
    EXPECT_GT(stored.basis.cols(), modes);
    EXPECT_LT(stored.basis.cols(), 40);
    modes = stored.basis.cols();
  }
}

TEST(SurfaceField, FieldsOfRankTwoNeedTwoModes) {
  Eigen::MatrixXd field = bumps(2) * Eigen::MatrixXd::Random(2, 12);
  const DisplacementField stored = compress_fields(pressed(field), 1e-4);
  EXPECT_EQ(stored.basis.cols(), 2);
  for (const double error : stored.error_relative) {
    EXPECT_LT(error, 1e-5);
  }
}

TEST(SurfaceField, NodesAndDepthsAreThoseOfThePresses) {
  const DisplacementField stored = compress_fields(pressed(bumps(3)), 0.1);
  EXPECT_EQ(stored.node, (std::vector<std::int32_t>{0, 1, 2}));
  EXPECT_DOUBLE_EQ(stored.depth_m[2], 0.003);
  EXPECT_EQ(stored.coefficient.rows(), 3);
  EXPECT_EQ(compress_fields({}, 0.1).node.size(), 0U);
}

}  // namespace
}  // namespace palpate

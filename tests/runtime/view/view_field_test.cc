// Displacement fields as pages get them.
#include "runtime/view/view_field.h"

#include <array>
#include <cmath>
#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "tests/support/base64_text.h"

namespace palpate {
namespace {

// Four vertices, of which node 2 was pressed twice and node 1 once.
ResponseTable table() {
  ResponseTable t;
  t.touch_offset_m.resize(4);
  t.displacement.basis = RowMajorMatrixF::Random(12, 3);
  t.displacement.coefficient.resize(3, 3);
  t.displacement.coefficient << 1e-3F, -2e-3F, 3e-4F, 2e-3F, 1e-3F, -4e-3F, 0.0F, 0.0F,
      0.0F;
  t.displacement.node = {2, 2, 1};
  t.displacement.depth_m = {0.002, 0.005, 0.003};
  t.displacement.error_relative = {0.01, 0.02, 0.03};
  return t;
}

TEST(ViewField, IsTheStoredDisplacementToHalfAStep) {
  const ResponseTable t = table();
  const nlohmann::json field = parse_json(field_text(t, 2));
  EXPECT_EQ(field["type"], "field");
  EXPECT_EQ(field["depth_m"], 0.005);  // the deeper of two
  EXPECT_EQ(field["error_relative"], 0.02);
  const std::string bytes = from_base64(field["displacement"].get<std::string>());
  ASSERT_EQ(bytes.size(), 2U * 12U);
  std::array<std::int16_t, 12> step{};
  std::memcpy(step.data(), bytes.data(), bytes.size());
  const double scale_m = field["scale_m"];
  const Eigen::VectorXd moved_m =
      t.displacement.basis.cast<double>() *
      t.displacement.coefficient.row(1).transpose().cast<double>();
  EXPECT_NEAR(scale_m, moved_m.cwiseAbs().maxCoeff() / 32767, 1e-12 * scale_m);
  for (std::size_t i = 0; i < step.size(); ++i) {
    EXPECT_NEAR(step[i] * scale_m, moved_m(static_cast<Eigen::Index>(i)),
                (0.5 + 1e-9) * scale_m);
  }
}

TEST(ViewField, OfASurfaceThatStandsStillIsZero) {
  const nlohmann::json field = parse_json(field_text(table(), 1));
  EXPECT_EQ(field["scale_m"], 0.0);
  EXPECT_EQ(from_base64(field["displacement"].get<std::string>()),
            std::string(24, '\0'));
}

TEST(ViewField, HasNoDepthWhereNoneIsStored) {
  const nlohmann::json field = parse_json(field_text(table(), 3));
  EXPECT_TRUE(field["depth_m"].is_null());
  EXPECT_FALSE(field.contains("displacement"));
}

TEST(ViewField, OfSinglesThatOverflowIsFinite) {
  ResponseTable t = table();
  t.displacement.basis.setConstant(3e38F);
  t.displacement.coefficient.setConstant(3e38F);
  const nlohmann::json field = parse_json(field_text(t, 2));
  EXPECT_TRUE(std::isfinite(field["scale_m"].get<double>()));
}

TEST(ViewField, OfANodeThatIsNotThereIsRefused) {
  for (const std::int32_t node : {-1, 4}) {
    EXPECT_THROW(static_cast<void>(field_text(table(), node)), InputError) << node;
  }
}

}  // namespace
}  // namespace palpate

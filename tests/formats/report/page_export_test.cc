// A page of a database: it carries what it renders, to the bit while it is small.
#include "formats/report/page_export.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/carried_page.h"
#include "tests/support/sample_bodies.h"

namespace palpate {
namespace {

const std::vector<std::byte> kNoModule(8);

// With all that a page may leave out, in digits that int16 does not hold.
ResponseDatabase full_plate() {
  ResponseDatabase database = sample_database(
      plate(0.1, 12), ball(0.005, 0.3, 5e-4),
      [](Eigen::Index node, double d) {
        return (200.0 + std::sqrt(static_cast<double>(node))) * d;
      },
      0.01);
  database.measurement = {.depth_m = {0.0, 0.001}, .force_n = {0.0, 0.2}};
  ResponseTable& table = database.tools[0];
  table.force_errors_n.assign(table.force_n.size(), 1e-3);
  const Eigen::Index vertices = database.body.position_m.rows();
  table.displacement.basis = RowMajorMatrixF::Random(3 * vertices, 2);
  table.displacement.coefficient = RowMajorMatrixF::Constant(1, 2, 1e-3F);
  table.displacement.node = {3};
  table.displacement.depth_m = {0.004};
  table.displacement.error_relative = {0.1};
  return database;
}

ResponseDatabase carried_by(const PageExport& page) {
  const std::vector<std::byte> flat = page_block(page.html, "database");
  return read_database(StoredSource(flat));
}

TEST(PageExport, RendersTheSameNumbersAndLeavesOutWhatNobodySees) {
  const ResponseDatabase database = full_plate();
  const PageExport page = page_of(database, "plate.h5", {}, kNoModule);
  const ResponseDatabase carried = carried_by(page);
  EXPECT_EQ(carried.tools[0].depth_m, database.tools[0].depth_m);
  EXPECT_EQ(carried.tools[0].force_n, database.tools[0].force_n);
  EXPECT_EQ(carried.tools[0].displacement.basis, database.tools[0].displacement.basis);
  EXPECT_TRUE(carried.measurement.depth_m.empty());
  EXPECT_TRUE(carried.tools[0].force_errors_n.empty());
  EXPECT_EQ(page.left_out,
            "This page leaves out raw measurements; uncertainties of samples.");
  EXPECT_NE(page_element(page.html, "about").find(page.left_out), std::string::npos);
}

TEST(PageExport, ALargerPageKeepsFewerDigitsThenNoDisplacements) {
  const ResponseDatabase database = full_plate();
  const std::size_t whole = page_of(database, "plate.h5", {}, kNoModule).html.size();
  const PageExport digits = page_of(database, "plate.h5", {}, kNoModule, {}, whole - 1);
  const ResponseDatabase carried = carried_by(digits);
  const ResponseTable& table = carried.tools[0];
  EXPECT_LT(digits.html.size(), whole);
  EXPECT_FALSE(table.displacement.node.empty());
  const double step_n = table.force_n.back() / 32767.0;
  double off_n = 0.0;
  for (std::size_t i = 0; i < table.force_n.size(); ++i) {
    off_n = std::max(off_n, std::abs(table.force_n[i] - database.tools[0].force_n[i]));
  }
  EXPECT_GT(off_n, 0.0);
  EXPECT_LT(off_n, step_n);
  const PageExport least = page_of(database, "plate.h5", {}, kNoModule, {}, 1);
  EXPECT_TRUE(carried_by(least).tools[0].displacement.node.empty());
  EXPECT_NE(least.left_out.find("displacements"), std::string::npos);
}

TEST(PageExport, ToolsAreNamedAndTwoAtMost) {
  EXPECT_THROW(static_cast<void>(page_of(full_plate(), "plate.h5", {"needle"}, {})),
               InputError);
  EXPECT_THROW(
      static_cast<void>(page_of(full_plate(), "plate.h5", {"ball", "b", "c"}, {})),
      InputError);
}

}  // namespace
}  // namespace palpate

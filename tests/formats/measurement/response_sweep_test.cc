#include "formats/measurement/response_sweep.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

ResponseSweep small_sweep() {
  ResponseSweep sweep{{{"body.youngs_modulus_pa", {1000.0, 3000.0, 9000.0}},
                       {"body.poissons_ratio", {0.1, 1.0 / 3.0}}},
                      {7, 3},
                      {1e-3, 2e-3, 4e-3},
                      {}};
  for (std::size_t v = 0; v < 2; ++v) {
    for (std::size_t c = 0; c < sweep.combinations(); ++c) {
      for (const double d : sweep.depth_m) {
        const auto value = sweep.values_at(c);
        sweep.force_n.push_back(value[0] / (1.0 - value[1] * value[1]) *
                                std::pow(d, 1.5) * static_cast<double>(v + 1));
      }
    }
  }
  return sweep;
}

TEST(ResponseSweep, ReadsBackBitForBit) {
  const ScratchFolder folder;
  ResponseSweep written = small_sweep();
  write_sweep(folder / "sweep.csv", written);
  EXPECT_EQ(read_sweep(folder / "sweep.csv").error_relative, 0.0);
  written.error_relative = 0.1 / 3.0;
  write_sweep(folder / "sweep.csv", written);
  const ResponseSweep read = read_sweep(folder / "sweep.csv");
  ASSERT_EQ(read.parameter.size(), 2U);
  EXPECT_EQ(read.parameter[1].name, "body.poissons_ratio");
  EXPECT_EQ(read.parameter[1].value, written.parameter[1].value);
  EXPECT_EQ(read.vertex, written.vertex);
  EXPECT_EQ(read.depth_m, written.depth_m);
  EXPECT_EQ(read.force_n, written.force_n);
  EXPECT_EQ(read.error_relative, written.error_relative);
}

TEST(ResponseSweep, LastParameterIsTheFastest) {
  const ResponseSweep sweep = small_sweep();
  EXPECT_EQ(sweep.combinations(), 6U);
  EXPECT_EQ(sweep.values_at(3), (std::vector<double>{3000.0, 1.0 / 3.0}));
  EXPECT_DOUBLE_EQ(sweep.curve_n(1, 3)[1],
                   2.0 * 3000.0 / (1.0 - 1.0 / 9.0) * std::pow(2e-3, 1.5));
}

TEST(ResponseSweep, RefusesWhatIsNotAWholeGrid) {
  const ScratchFolder folder;
  write_sweep(folder / "sweep.csv", small_sweep());
  std::ifstream in(folder / "sweep.csv");
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::string last = text.substr(text.rfind('\n', text.size() - 2) + 1);
  const auto refused = [&](const std::string& content) {
    std::ofstream(folder / "bad.csv") << content;
    EXPECT_THROW((void)read_sweep(folder / "bad.csv"), FormatError) << content;
  };
  refused(text.substr(0, text.size() - last.size()));  // a row is missing
  refused(text + last);                                // one is there twice
  refused("# palpate response sweep 2" + text.substr(text.find('\n')));
  refused(text.substr(text.find('\n') + 1));  // no first line
  refused(text.substr(0, text.size() - last.size()) + "3,9000,0.1,x,1\n");
  EXPECT_THROW((void)read_sweep(folder / "absent.csv"), InputError);
}

TEST(ResponseSweep, RefusesToWriteForcesThatAreNotPositive) {
  const ScratchFolder folder;
  ResponseSweep sweep = small_sweep();
  sweep.force_n[4] = 0.0;
  EXPECT_THROW(write_sweep(folder / "sweep.csv", sweep), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder / "sweep.csv"));
  sweep = small_sweep();
  sweep.parameter[0].value[1] = 500.0;
  EXPECT_THROW(check(sweep), InputError);
}

}  // namespace
}  // namespace palpate

#include "precompute/process/machine_memory.h"

#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// Rows of factor_study [GB].
TEST(MachineMemory, TheExpectationIsWhatAnOrganNeedsAndMoreThanACylinder) {
  EXPECT_NEAR(expected_memory_bytes(5120) / 0.551e9, 1.0, 0.05);
  EXPECT_NEAR(expected_memory_bytes(20480) / 3.002e9, 1.0, 0.05);
  EXPECT_GT(expected_memory_bytes(6936) / 0.633e9, 1.0);
  EXPECT_GT(expected_memory_bytes(15000) / 1.578e9, 1.0);
  EXPECT_LT(expected_memory_bytes(15000) / 1.578e9, 1.4) << "refuses what fits";
}

TEST(MachineMemory, ABodyThatFitsIsTakenAndOneThatDoesNotIsToldWhatToDo) {
  EXPECT_GT(free_memory_bytes(), 10'000'000);
  EXPECT_NO_THROW(require_memory(4));
  try {
    require_memory(1'000'000'000'000);
    FAIL() << "was taken";
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("of 1000000000000 surface triangles needs about"),
              std::string::npos)
        << what;
    EXPECT_NE(what.find("[cutout] radius_m"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace palpate

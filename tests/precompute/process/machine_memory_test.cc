#include "precompute/process/machine_memory.h"

#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

TEST(MachineMemory, TheExpectationIsThatOfTheStudy) {
  // Rows of factor_study, cylinder: 0.627 GB and 1.569 GB.
  EXPECT_NEAR(expected_memory_bytes(6936) / 0.627e9, 1.0, 0.05);
  EXPECT_NEAR(expected_memory_bytes(15000) / 1.569e9, 1.0, 0.05);
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

#include "precompute/machine_memory.h"

#include <string>

#include <gtest/gtest.h>

#include "formats/error.h"

namespace palpate {
namespace {

TEST(MachineMemory, TheExpectationIsThatOfTheStudy) {
  // Rows of factor_study, organ: 0.537 GB and 2.99 GB.
  EXPECT_NEAR(expected_memory_bytes(5120) / 0.537e9, 1.0, 0.15);
  EXPECT_NEAR(expected_memory_bytes(20480) / 2.99e9, 1.0, 0.15);
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

// The same test on a processor without fused operations, for which the C library has
// other functions.
#pragma once

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/run_tool.h"

namespace palpate {

/// What a disabled test prints in a process of its own, whose C library is told that
/// the processor has neither FMA nor AVX2.
/// @param program of the tests, e.g. "formats_base_tests".
inline std::string printed_without_fma(const std::string& program,
                                       const std::string& test) {
  setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F", 1);
  const ToolRun run = run_tool_process(
      program, {"--gtest_also_run_disabled_tests", "--gtest_filter=" + test});
  unsetenv("GLIBC_TUNABLES");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return run.out;
}

}  // namespace palpate

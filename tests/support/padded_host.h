// A padded plate as a host program opens it through palpate.h.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "runtime/c_api/palpate.h"
#include "tests/support/padded_plate.h"
#include "tests/support/test_data.h"

namespace palpate {

class PaddedHost : public testing::Test {
 protected:
  void SetUp() override {
    write_database(file_, padded_plate(3));
    write_database(without_, padded_plate(3, false));
  }
  void TearDown() override { palpate_close(body_); }

  static palpate_options options(const char* tool) {
    palpate_options all{};
    all.struct_size = sizeof all;
    all.flags = PALPATE_OWN_SLOW_STEPS;
    all.tool_name = tool;
    return all;
  }

  ScratchFolder folder_;
  std::string file_ = (folder_ / "pads.h5").string();
  std::string without_ = (folder_ / "without.h5").string();
  palpate_body* body_ = nullptr;
  char error_[512] = {};
};

}  // namespace palpate

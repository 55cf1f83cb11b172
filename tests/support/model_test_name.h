// The name of a test that runs with each of several local models.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "runtime/account/local_model.h"

namespace palpate {

/// "energytank": GoogleTest takes no hyphens.
inline std::string model_test_name(const testing::TestParamInfo<LocalModel>& model) {
  std::string text(name(model.param));
  std::erase(text, '-');
  return text;
}

}  // namespace palpate

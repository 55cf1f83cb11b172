// What the program says.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace palpate {

/// The text of the Error that a call throws; empty where it throws none.
template <typename Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline void expect_says(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

}  // namespace palpate

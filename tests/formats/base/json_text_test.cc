// JSON as text: there and back, and what is no UTF-8 or no JSON.
#include "formats/base/json_text.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace palpate {
namespace {

TEST(JsonText, PrintsAndParses) {
  const nlohmann::json sorted = {{"b", 0.1}, {"a", {1, nullptr, true}}};
  EXPECT_EQ(json_text(sorted), R"({"a":[1,null,true],"b":0.1})");
  EXPECT_EQ(parse_json(json_text(sorted, 2)), sorted);
  const nlohmann::ordered_json ordered = {{"b", 0.1}, {"a", "x"}};
  EXPECT_EQ(json_text(ordered, 1), "{\n \"b\": 0.1,\n \"a\": \"x\"\n}");
  EXPECT_EQ(parse_ordered_json(json_text(ordered)), ordered);
}

TEST(JsonText, WhatIsNoUtf8IsReplaced) {
  const nlohmann::ordered_json name =
      "a\xff"
      "b\xc3\xa9";
  EXPECT_EQ(json_text(name),
            "\"a\xef\xbf\xbd"
            "b\xc3\xa9\"");
  EXPECT_EQ(ascii_json_text(name), R"("a\ufffdb\u00e9")");
}

TEST(JsonText, WhatIsNoJsonIsDiscarded) {
  for (const char* const text : {"", "{", "[1,]", "\"\xff\"", "{} {}"}) {
    EXPECT_TRUE(parse_json(text).is_discarded()) << text;
    EXPECT_TRUE(parse_ordered_json(text).is_discarded()) << text;
  }
}

}  // namespace
}  // namespace palpate

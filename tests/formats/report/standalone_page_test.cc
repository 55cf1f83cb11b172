// A page of its own: what it carries comes out as it went in, and its policy lets it
// load nothing.
#include "formats/report/standalone_page.h"

#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/report/gzip_bytes.h"
#include "tests/support/carried_page.h"

namespace palpate {
namespace {

std::vector<std::byte> some_bytes(std::size_t count) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>((i * i + i / 7) % 251));
  }
  return bytes;
}

std::string page() {
  const std::vector<std::byte> module = some_bytes(1000), flat = some_bytes(30000);
  return standalone_page({.name = "</script><b>.h5",
                          .tools = {"ball", "pads"},
                          .left_out = "nothing",
                          .flat = flat},
                         module);
}

TEST(GzipBytes, AreUnpackedToWhatWasPacked) {
  for (const std::size_t count : {0, 1, 100000}) {
    const std::vector<std::byte> bytes = some_bytes(count);
    EXPECT_EQ(from_gzip(gzip_bytes(bytes)), bytes);
  }
  EXPECT_LT(gzip_bytes(std::vector<std::byte>(100000)).size(), 1000U);
}

TEST(StandalonePage, CarriesDatabaseModuleAndNames) {
  const std::string html = page();
  EXPECT_EQ(page_block(html, "database"), some_bytes(30000));
  EXPECT_EQ(page_block(html, "module"), some_bytes(1000));
  const auto about = nlohmann::json::parse(page_element(html, "about"));
  EXPECT_EQ(about["name"], "</script><b>.h5");
  EXPECT_EQ(about["tools"], (std::vector<std::string>{"ball", "pads"}));
  EXPECT_EQ(about["left_out"], "nothing");
  EXPECT_EQ(page(), html);
}

TEST(StandalonePage, LoadsNothingAndReachesItsDeviceAlone) {
  const std::string html = page();
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(html.find("src=\""), std::string::npos);
  EXPECT_EQ(html.find("<link rel=\"stylesheet\""), std::string::npos);
  EXPECT_NE(html.find("; connect-src ws://127.0.0.1:10001 ws://127.0.0.1:10020\">"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate

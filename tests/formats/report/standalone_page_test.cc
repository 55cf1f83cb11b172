// A page of its own: what it carries comes out as it went in, and its policy lets it
// load nothing.
#include "formats/report/standalone_page.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include "formats/report/gzip_bytes.h"
#include "formats/report/html_page.h"

namespace palpate {
namespace {

std::vector<std::byte> some_bytes(std::size_t count) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>((i * i + i / 7) % 251));
  }
  return bytes;
}

std::vector<std::byte> unpacked(std::span<const std::byte> packed, std::size_t room) {
  std::vector<std::byte> bytes(room);
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, MAX_WBITS + 16), Z_OK);
  std::vector<std::byte> from(packed.begin(), packed.end());
  stream.next_in = reinterpret_cast<Bytef*>(from.data());
  stream.avail_in = static_cast<uInt>(from.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  bytes.resize(stream.total_out);
  inflateEnd(&stream);
  return bytes;
}

// The text of an element of the page.
std::string element(const std::string& html, const std::string& id) {
  const std::size_t begin = html.find('>', html.find("id=\"" + id + "\"")) + 1;
  return html.substr(begin, html.find("</script>", begin) - begin);
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
    EXPECT_EQ(unpacked(gzip_bytes(bytes), count + 1), bytes);
  }
  EXPECT_LT(gzip_bytes(std::vector<std::byte>(100000)).size(), 1000U);
}

TEST(StandalonePage, CarriesDatabaseModuleAndNames) {
  const std::string html = page();
  EXPECT_EQ(element(html, "database"), base64(gzip_bytes(some_bytes(30000))));
  EXPECT_EQ(element(html, "module"), base64(gzip_bytes(some_bytes(1000))));
  const auto about = nlohmann::json::parse(element(html, "about"));
  EXPECT_EQ(about["name"], "</script><b>.h5");
  EXPECT_EQ(about["tools"], (std::vector<std::string>{"ball", "pads"}));
  EXPECT_EQ(about["left_out"], "nothing");
  EXPECT_EQ(page(), html);
}

TEST(StandalonePage, LoadsNothing) {
  const std::string html = page();
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(html.find("src=\""), std::string::npos);
  EXPECT_EQ(html.find("<link rel=\"stylesheet\""), std::string::npos);
  EXPECT_EQ(html.find("connect-src"), std::string::npos);
}

}  // namespace
}  // namespace palpate

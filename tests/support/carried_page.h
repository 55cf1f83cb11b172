// What a page of its own carries, taken out again.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

namespace palpate {

/// The text of an element of the page.
inline std::string page_element(const std::string& html, const std::string& id) {
  const std::size_t begin = html.find('>', html.find("id=\"" + id + "\"")) + 1;
  return html.substr(begin, html.find("</script>", begin) - begin);
}

inline std::vector<std::byte> from_gzip(std::span<const std::byte> packed) {
  std::vector<std::byte> bytes;
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, MAX_WBITS + 16), Z_OK);
  std::vector<std::byte> from(packed.begin(), packed.end());
  stream.next_in = reinterpret_cast<Bytef*>(from.data());
  stream.avail_in = static_cast<uInt>(from.size());
  int status = Z_OK;
  while (status == Z_OK) {
    bytes.resize(bytes.size() + 65536);
    stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + stream.total_out);
    stream.avail_out = static_cast<uInt>(bytes.size() - stream.total_out);
    status = inflate(&stream, Z_NO_FLUSH);
  }
  EXPECT_EQ(status, Z_STREAM_END);
  bytes.resize(stream.total_out);
  inflateEnd(&stream);
  return bytes;
}

inline std::vector<std::byte> from_base64(const std::string& text) {
  const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::byte> bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char digit : text) {
    if (digit == '=') {
      break;
    }
    group = (group << 6U | static_cast<unsigned>(digits.find(digit))) & 0xFFFFU;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<std::byte>(group >> static_cast<unsigned>(bits)));
    }
  }
  return bytes;
}

/// The bytes that an element carries.
inline std::vector<std::byte> page_block(const std::string& html,
                                         const std::string& id) {
  return from_gzip(from_base64(page_element(html, id)));
}

}  // namespace palpate

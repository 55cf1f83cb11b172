#include "formats/base/portable_sha256.h"

#include <string>
#include <string_view>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formats/base/sha256.h"

namespace palpate {
namespace {

std::string hex(std::string_view text) {
  PortableSha256 digest;
  digest.update(std::as_bytes(std::span(text)));
  std::string result;
  for (const std::uint8_t byte : digest.digest()) {
    result += fmt::format("{:02x}", byte);
  }
  return result;
}

// Examples of FIPS 180-4 and of its collection of test vectors.
TEST(PortableSha256, MeetsThePublishedExamples) {
  EXPECT_EQ(hex(""),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hex("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Sha256 is OpenSSL's here.
TEST(PortableSha256, IsThatOfTheLibraryForEveryLength) {
  Sha256 library;
  PortableSha256 grown;
  std::string text;
  for (int length = 0; length < 300; ++length) {
    ASSERT_EQ(hex(text), library.hex()) << length;
    const char next = static_cast<char>(7 * length);
    const auto byte = std::as_bytes(std::span(&next, 1));
    library.update(byte);
    grown.update(byte);
    text += next;
  }
  PortableSha256 whole;
  whole.update(std::as_bytes(std::span(text)));
  EXPECT_EQ(grown.digest(), whole.digest());
}

}  // namespace
}  // namespace palpate

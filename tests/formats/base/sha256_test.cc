#include "formats/base/sha256.h"

#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// Examples of FIPS 180-4: the empty message, and "abc".
constexpr const char* kOfNothing =
    "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr const char* kOfAbc =
    "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

void add(Sha256& digest, const std::string& text) {
  digest.update(std::as_bytes(std::span(text.data(), text.size())));
}

TEST(Sha256, MeetsThePublishedExamples) {
  Sha256 digest;
  EXPECT_EQ(digest.hex(), kOfNothing);
  add(digest, "abc");
  EXPECT_EQ(digest.hex(), kOfAbc);
}

TEST(Sha256, DoesNotSeeHowTheBytesWereCut) {
  Sha256 digest;
  add(digest, "a");
  EXPECT_NE(digest.hex(), kOfAbc);
  add(digest, "");
  add(digest, "bc");
  EXPECT_EQ(digest.hex(), kOfAbc);
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const ScratchFolder folder;
  const std::string large(200000, 'x');
  std::ofstream(folder / "a") << large;
  Sha256 digest;
  add(digest, large);
  EXPECT_EQ(sha256_of_file(folder / "a"), digest.hex());
  EXPECT_THROW((void)sha256_of_file(folder / "no"), InputError);
  EXPECT_THROW((void)sha256_of_file(folder.path()), InputError);
}

}  // namespace
}  // namespace palpate

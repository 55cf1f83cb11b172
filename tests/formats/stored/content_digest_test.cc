#include "formats/stored/content_digest.h"

#include <array>

#include <gtest/gtest.h>

namespace palpate {
namespace {

std::string sha256_of(const std::string& bytes) {
  Sha256 digest;
  digest.update(std::as_bytes(std::span(bytes)));
  return digest.hex();
}

std::string bytes_of_doubles(const std::vector<double>& values) {
  return {reinterpret_cast<const char*>(values.data()), 8 * values.size()};
}

// The example of FORMAT.md, "Digest".
TEST(ContentDigestItems, BeginWithTheirOwnLine) {
  ContentDigest text;
  text.add_text("/@format", "palpate-response-database");
  EXPECT_EQ(text.hex(), sha256_of("/@format text 25 0\npalpate-response-database"));
  ContentDigest dataset;
  const std::vector<double> values{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  dataset.add_dataset("/body/x", StoredType::kFloat64, {2, 3}, values.data());
  EXPECT_EQ(dataset.hex(),
            sha256_of("/body/x float64 2 3\n" + bytes_of_doubles(values)));
}

TEST(ContentDigestItems, OneNumberHasOneRow) {
  ContentDigest digest;
  const double value = 0.25;
  digest.add_number("/tools/ball@radius_m", StoredType::kFloat64, &value);
  EXPECT_EQ(digest.hex(), sha256_of("/tools/ball@radius_m float64 1 0\n" +
                                    bytes_of_doubles({value})));
}

TEST(ContentDigestItems, RealsAreDoublesOfOneColumn) {
  ContentDigest reals;
  ContentDigest dataset;
  const std::vector<double> values{1.0, -2.0};
  reals.add_reals("/d", values);
  dataset.add_dataset("/d", StoredType::kFloat64, {2}, values.data());
  EXPECT_EQ(reals.hex(), dataset.hex());
}

}  // namespace
}  // namespace palpate

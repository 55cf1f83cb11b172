#include "tests/bench/runtime/bench_contacts.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "formats/base/json_text.h"

namespace palpate {
namespace {

std::uint64_t no_allocations() {
  return 0;
}

const std::vector<ContactsBenchRow>& contacts_rows() {
  static const std::vector<ContactsBenchRow> kRows =
      run_contacts_bench({.ticks = 3000}, no_allocations);
  return kRows;
}

// A plate of touching spheres is several times too stiff without coupling: measured
// with boundary elements, 0.61 of the sum for 4 spheres, 0.35 for 16, 0.2 for 64.
TEST(ContactsBench, CouplingTakesForceAndGivesNoEnergy) {
  ASSERT_EQ(contacts_rows().size(), 20U);
  for (std::size_t i = 0; i < contacts_rows().size(); i += 5) {
    const ContactsBenchRow& sum = contacts_rows()[i];
    const ContactsBenchRow& coupled = contacts_rows()[i + 2];
    EXPECT_FALSE(sum.coupled);
    EXPECT_TRUE(coupled.coupled);
    if (sum.contacts == 1) {
      EXPECT_EQ(sum.force_max_n, coupled.force_max_n);
    } else {
      EXPECT_LT(coupled.force_max_n, 0.8 * sum.force_max_n) << sum.contacts;
    }
    EXPECT_TRUE(contacts_rows()[i + 4].relaxing);
    EXPECT_LT(contacts_rows()[i + 4].force_max_n, contacts_rows()[i + 3].force_max_n);
    for (std::size_t j = i; j < i + 5; ++j) {
      EXPECT_GE(contacts_rows()[j].lowest_work_j, -1e-12);
      EXPECT_FALSE(contacts_rows()[j].scaled);
      EXPECT_GT(contacts_rows()[j].touching, 0.0);
    }
  }
}

TEST(ContactsBench, ReportHasItsKeys) {
  const auto json = parse_json(to_json(contacts_rows()));
  ASSERT_EQ(json["rows"].size(), 20U);
  for (const char* key : {"contacts", "coupled", "median_us", "p999_us", "factorings",
                          "lowest_work_j", "allocations"}) {
    EXPECT_TRUE(json["rows"][0].contains(key)) << key;
  }
}

}  // namespace
}  // namespace palpate

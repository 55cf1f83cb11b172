// Pressures and lateral stiffnesses in a file: kept, read in whole and by chunk,
// sliced, refused where wrong.
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_rules.h"
#include "formats/database/response_database.h"
#include "formats/database/select_nodes.h"
#include "formats/database/work_unit.h"
#include "tests/support/contact_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

void expect_same_contacts(const ContactTable& a, const ContactTable& b) {
  EXPECT_EQ(a.centre_m, b.centre_m);
  EXPECT_EQ(a.moment_m2, b.moment_m2);
  EXPECT_EQ(a.exponent, b.exponent);
  EXPECT_EQ(a.lateral, b.lateral);
  EXPECT_EQ(a.lateral_error, b.lateral_error);
}

class StoredContacts : public testing::Test {
 protected:
  static void expect_refused(const std::function<void(ContactTable&)>& change,
                             const std::string& said) {
    ResponseDatabase database = with_contacts();
    change(database.tools.front().contact);
    try {
      check(database);
      FAIL() << "accepted, not " << said;
    } catch (const FormatError& error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos)
          << error.what();
    }
  }
  ScratchFolder folder_;
};

TEST_F(StoredContacts, AreReadAsTheyWereWritten) {
  const ResponseDatabase written = with_contacts();
  write_database(folder_ / "a.h5", written);
  const ResponseDatabase read = read_database(folder_ / "a.h5");
  expect_same_contacts(read.tools[0].contact, written.tools[0].contact);
  EXPECT_TRUE(read.tools[1].contact.empty());
}

TEST_F(StoredContacts, ComeWithTheChunksThatARendererReads) {
  ResponseDatabase database = with_contacts();
  database.storage.chunk_nodes = 2;
  write_database(folder_ / "a.h5", database);
  const ResponseDatabase whole = read_in_file_order(folder_ / "a.h5");
  const ChunkReader reader(folder_ / "a.h5");
  for (std::int64_t k = 0; k < 3; ++k) {
    const std::array<std::int32_t, 2> nodes{static_cast<std::int32_t>(2 * k),
                                            static_cast<std::int32_t>(2 * k + 1)};
    expect_same_contacts(reader.responses(0, k).contact,
                         rows_of(whole.tools[0].contact, nodes));
    EXPECT_TRUE(reader.responses(1, k).contact.empty());
  }
}

TEST_F(StoredContacts, OneKindAloneIsKeptToo) {
  ResponseDatabase written = with_contacts();
  ContactTable& contact = written.tools[0].contact;
  contact.lateral.resize(0, 12);
  contact.lateral_error.resize(0, 1);
  write_database(folder_ / "a.h5", written);
  const ContactTable read = read_database(folder_ / "a.h5").tools[0].contact;
  EXPECT_TRUE(read.has_pressure());
  EXPECT_FALSE(read.has_lateral());
  EXPECT_EQ(ChunkReader(folder_ / "a.h5").responses(0, 0).contact.moment_m2,
            read_in_file_order(folder_ / "a.h5").tools[0].contact.moment_m2);
}

TEST_F(StoredContacts, AreHeldToTheRules) {
  expect_refused(
      [](ContactTable& t) {
        t.lateral(2, 0) = -1.0F;
      },
      "/tools/tip: node 2 has a lateral/stiffness");
  expect_refused(
      [](ContactTable& t) {
        t.moment_m2(1, 1) = 1.0F;
      },
      "node 1 has a pressure/moment_m2");
  expect_refused(
      [](ContactTable& t) {
        t.exponent.conservativeResize(5, 4);
      },
      "/tools/tip/pressure/exponent has 5 x 4 numbers, must have 6 x 4");
  expect_refused(
      [](ContactTable& t) {
        t.lateral_error.resize(0, 1);
      },
      "/tools/tip/lateral/error_relative has 0 x");
}

TEST_F(StoredContacts, TravelWithAUnitOfWork) {
  const ContactTable contact = with_contacts().tools[0].contact;
  WorkUnitOutcome unit{.index = 3, .node = {}};
  unit.node.push_back({.vertex = 1, .response = {}});
  const std::array<std::int32_t, 1> second{1};
  unit.node.front().response.contact = rows_of(contact, second);
  const WorkUnitOutcome read = unit_from_bytes(to_bytes(unit), "a unit");
  expect_same_contacts(read.node.front().response.contact, rows_of(contact, second));
}

}  // namespace
}  // namespace palpate

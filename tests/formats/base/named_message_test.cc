#include "formats/base/named_message.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(NamedMessage, HasTheNameOnce) {
  for (const char* message : {"no numbers", "lab/x.csv: no numbers",
                              "/data/lab/x.csv: no numbers", "x.csv: no numbers"}) {
    EXPECT_EQ(with_name("lab/x.csv", message), "lab/x.csv: no numbers") << message;
  }
  EXPECT_EQ(with_name("lab/x.h5#3", "/data/lab/x.h5: no curve"),
            "lab/x.h5#3: no curve");
  EXPECT_EQ(without_name("lab/x.csv: column: none", "lab/x.csv"), "column: none");
}

TEST(NamedMessage, KeepsTheNamesOfOtherFiles) {
  EXPECT_EQ(without_name("lab/ax.csv: no numbers", "x.csv"), "lab/ax.csv: no numbers");
  EXPECT_EQ(without_name("adhesion: it pulls", "x.csv"), "adhesion: it pulls");
  EXPECT_EQ(without_name(": it pulls", "x.csv"), ": it pulls");
  EXPECT_EQ(without_name("no numbers", "x.csv"), "no numbers");
}

}  // namespace
}  // namespace palpate

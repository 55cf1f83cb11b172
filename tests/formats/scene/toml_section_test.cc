#include "formats/scene/toml_section.h"

#include <cmath>
#include <limits>

#include "formats/base/toml_text.h"
#include "tests/support/said.h"

namespace palpate {
namespace {

// A table of a file, kept as long as its section.
struct SectionOfText {
  explicit SectionOfText(const std::string& text) : root(parse_toml(text, file)) {}
  std::string file = "a.toml";
  toml::table root;
  SceneSection section{file, "[it]", root};
};

template <typename Read>
std::string section_refusal(const std::string& text, const Read& read) {
  const SectionOfText it(text);
  return refusal([&] {
    read(it.section);
  });
}

std::string number_refusal(const std::string& value, const NumberRule& rule) {
  return section_refusal("k = " + value, [&](const SceneSection& section) {
    (void)section.number("k", rule);
  });
}

double number_in(const std::string& value, const NumberRule& rule) {
  return SectionOfText("k = " + value).section.number("k", rule);
}

TEST(TomlSection, ANumberMayBeWrittenWhole) {
  EXPECT_EQ(number_in("3", kPositive), 3.0);
  EXPECT_EQ(number_in("-3", {[](double v) {
                               return v < 0.0;
                             },
                             "negative"}),
            -3.0);
  EXPECT_EQ(number_in("1e-310", kPositive), 1e-310);
  EXPECT_EQ(number_in("1.7976931348623157e308", kPositive),
            std::numeric_limits<double>::max());
}

TEST(TomlSection, ZeroIsNotPositiveAndNotNegative) {
  EXPECT_EQ(number_in("0", kNotNegative), 0.0);
  EXPECT_EQ(number_refusal("0", kPositive),
            "a.toml:1: k in [it] is 0, must be positive and finite");
  EXPECT_EQ(number_refusal("-1e-300", kNotNegative),
            "a.toml:1: k in [it] is -1e-300, must be zero or more and finite");
}

TEST(TomlSection, WhatIsNotFiniteIsRefusedByEveryRule) {
  const NumberRule anything{[](double) {
                              return true;
                            },
                            "finite"};
  for (const char* value : {"nan", "inf", "-inf"}) {
    EXPECT_NE(number_refusal(value, anything), "") << value;
    EXPECT_NE(section_refusal(std::string("k = [1, ") + value + "]",
                              [&](const SceneSection& section) {
                                (void)section.numbers("k", anything, 9);
                              }),
              "")
        << value;
    EXPECT_NE(section_refusal(std::string("k = [0, 0, ") + value + "]",
                              [](const SceneSection& section) {
                                (void)section.vector("k");
                              }),
              "")
        << value;
  }
}

TEST(TomlSection, OtherKindsAreNoNumbers) {
  EXPECT_EQ(number_refusal("\"5\"", kPositive),
            "a.toml:1: k in [it] is a text, must be a number");
  EXPECT_EQ(number_refusal("true", kPositive),
            "a.toml:1: k in [it] is true or false, must be a number");
  EXPECT_EQ(number_refusal("[5]", kPositive),
            "a.toml:1: k in [it] is an array, must be a number");
  EXPECT_EQ(number_refusal("{ v = 5 }", kPositive),
            "a.toml:1: k in [it] is a table, must be a number");
  EXPECT_EQ(number_refusal("2020-01-01", kPositive),
            "a.toml:1: k in [it] is a date or time, must be a number");
}

TEST(TomlSection, AMistakeIsNamedByTheLineOfItsValue) {
  EXPECT_EQ(section_refusal("a = 1\n\nk = -1\n",
                            [](const SceneSection& section) {
                              (void)section.number("k", kPositive);
                            }),
            "a.toml:3: k in [it] is -1, must be positive and finite");
}

TEST(TomlSection, DefaultsStandOnlyForKeysThatAreNotThere) {
  const SectionOfText it("n = 2\nb = false\ni = 4\nc = \"y\"");
  constexpr std::string_view kChoices[] = {"x", "y"};
  EXPECT_EQ(it.section.number_or(7.0, "n", kPositive), 2.0);
  EXPECT_EQ(it.section.number_or(-7.0, "none", kPositive), -7.0);
  EXPECT_FALSE(it.section.boolean_or(true, "b"));
  EXPECT_TRUE(it.section.boolean_or(true, "none"));
  EXPECT_EQ(it.section.integer_or(7, "i", 0, 5), 4);
  EXPECT_EQ(it.section.integer_or(7, "none", 0, 5), 7);
  EXPECT_EQ(it.section.choice_or("x", "c", kChoices), "y");
  EXPECT_EQ(it.section.choice_or("x", "none", kChoices), "x");
  EXPECT_EQ(refusal([&] {
              (void)it.section.number("none", kPositive);
            }),
            "a.toml:1: [it] needs the key \"none\"");
}

TEST(TomlSection, WholeNumbersEndAtBothBounds) {
  const auto read = [](const std::string& value) {
    return SectionOfText("k = " + value).section.integer_or(0, "k", -2, 64);
  };
  const auto error = [&](const std::string& value) {
    return refusal([&] {
      (void)read(value);
    });
  };
  EXPECT_EQ(read("-2"), -2);
  EXPECT_EQ(read("64"), 64);
  EXPECT_EQ(error("65"), "a.toml:1: k in [it] is 65, must be in [-2, 64]");
  EXPECT_EQ(error("-3"), "a.toml:1: k in [it] is -3, must be in [-2, 64]");
  // Equal to 1 in 32 bits.
  EXPECT_EQ(error("4294967297"),
            "a.toml:1: k in [it] is 4294967297, must be in [-2, 64]");
  for (const char* value : {"2.0", "\"2\"", "true"}) {
    EXPECT_EQ(error(value), "a.toml:1: k in [it] must be a whole number in [-2, 64]");
  }
}

TEST(TomlSection, ANumberIsNoTruthValue) {
  EXPECT_EQ(section_refusal("k = 1",
                            [](const SceneSection& section) {
                              (void)section.boolean_or(false, "k");
                            }),
            "a.toml:1: k in [it] is a number, must be true or false");
}

TEST(TomlSection, TextsAreNotEmptyAndChoicesAreAmongThoseThereAre) {
  constexpr std::string_view kChoices[] = {"auto", "all"};
  const auto choice = [&](const std::string& value) {
    return section_refusal("k = " + value, [&](const SceneSection& section) {
      (void)section.choice("k", kChoices);
    });
  };
  EXPECT_EQ(choice("\"all\""), "");
  EXPECT_EQ(choice("\"\""), "a.toml:1: k in [it] is empty, must be a text");
  EXPECT_EQ(choice("3"), "a.toml:1: k in [it] is a number, must be a text");
  EXPECT_EQ(choice("\"al\""),
            "a.toml:1: k \"al\" in [it] is not available; available: auto, all");
}

TEST(TomlSection, ListsHaveOneToTheMostNumbersInOrder) {
  const auto read = [](const std::string& value) {
    return SectionOfText("k = " + value).section.numbers("k", kPositive, 3);
  };
  EXPECT_EQ(read("[1]"), (std::vector<double>{1.0}));
  EXPECT_EQ(read("[3, 0.5, 2]"), (std::vector<double>{3.0, 0.5, 2.0}));
  for (const char* value : {"[]", "[1, 2, 3, 4]", "1"}) {
    EXPECT_EQ(refusal([&] {
                (void)read(value);
              }),
              "a.toml:1: k in [it] must be a list of 1 to 3 numbers");
  }
  EXPECT_EQ(refusal([&] {
              (void)read("[1, -2]");
            }),
            "a.toml:1: k in [it] holds -2, must be positive and finite");
  EXPECT_EQ(refusal([&] {
              (void)read("[1, \"2\"]");
            }),
            "a.toml:1: k in [it] is a text, must be a number");
}

TEST(TomlSection, PointsKeepTheirOrderAndAxes) {
  const SectionOfText it("k = [[1, 2, 3], [-4, 5.5, 6]]");
  const Points points = it.section.points("k", 2);
  ASSERT_EQ(points.rows(), 2);
  EXPECT_EQ(points.row(0), Eigen::RowVector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(points.row(1), Eigen::RowVector3d(-4.0, 5.5, 6.0));
  EXPECT_NE(refusal([&] {
              (void)it.section.points("k", 1);
            }),
            "");
  const auto error = [](const std::string& value) {
    return section_refusal("k = " + value, [](const SceneSection& section) {
      (void)section.points("k", 4);
    });
  };
  expect_says(error("[]"), "k in [it] must be a list of 1 to 4 points");
  EXPECT_EQ(error("[[1, 2, 3], [1, 2]]"),
            "a.toml:1: point 1 of k in [it] must have three coordinates: [x, y, z]");
  EXPECT_EQ(error("[[1, 2, inf]]"),
            "a.toml:1: a coordinate of point 0 of k in [it] is inf, must be finite");
}

TEST(TomlSection, ABoxMayBeThinAndItsFirstCornerIsTheLower) {
  const SectionOfText thin("k = [[-1, 0, 2], [1, 0, 3]]");
  EXPECT_EQ(thin.section.box("k").min(), Eigen::Vector3d(-1.0, 0.0, 2.0));
  EXPECT_EQ(thin.section.box("k").max(), Eigen::Vector3d(1.0, 0.0, 3.0));
  const auto error = [](const std::string& value) {
    return section_refusal("k = " + value, [](const SceneSection& section) {
      (void)section.box("k");
    });
  };
  EXPECT_EQ(error("[[0, 0, 2], [1, 1, 1]]"),
            "a.toml:1: k in [it] goes from 2 to 1 along z, the first corner must be "
            "the lower one");
  expect_says(error("[[0, 2, 0], [1, 1, 1]]"), "along y");
  expect_says(error("[[0, 0, 0]]"), "must be two corners");
  expect_says(error("[[0, 0, 0], [1, 1, 1], [2, 2, 2]]"), "must be two corners");
  expect_says(error("[[0, 0, 0], [1, 1]]"), "a corner of k in [it]");
}

TEST(TomlSection, ADirectionIsUnitAtAnyLength) {
  const Eigen::Vector3d wanted(0.6, 0.0, -0.8);
  for (const char* value : {"[3, 0, -4]", "[3e-320, 0, -4e-320]", "[3e307, 0, -4e307]",
                            "[1.2e308, 0, -1.6e308]"}) {
    const SectionOfText it(std::string("k = ") + value);
    const Eigen::Vector3d along = it.section.direction("k");
    // The smallest are multiples of 5e-324: 4e-320 is known to 1 part in 8000.
    EXPECT_TRUE(along.isApprox(wanted, 2e-4)) << value << ": " << along.transpose();
    EXPECT_NEAR(along.norm(), 1.0, 4e-16) << value;
  }
  EXPECT_EQ(section_refusal("k = [0, -0.0, 0]",
                            [](const SceneSection& section) {
                              (void)section.direction("k");
                            }),
            "a.toml:1: k in [it] is [0, 0, 0], must have a direction");
}

TEST(TomlSection, ATableWithinNamesItselfAndKnowsItsKeys) {
  constexpr std::string_view kKeys[] = {"center_m", "radius_m"};
  const SectionOfText it("k = { radius_m = -1 }\nother = 3\nbad = { radius = 1 }");
  const SceneSection inner = it.section.table("k", kKeys);
  EXPECT_EQ(inner.title(), "k of [it]");
  expect_says(refusal([&] {
                (void)inner.number("radius_m", kPositive);
              }),
              "radius_m in k of [it] is -1");
  EXPECT_EQ(refusal([&] {
              (void)it.section.table("other", kKeys);
            }),
            "a.toml:2: other in [it] is a number, must be a table: { center_m, "
            "radius_m }");
  EXPECT_EQ(refusal([&] {
              (void)it.section.table("bad", kKeys);
            }),
            "a.toml:3: unknown key \"radius\" in bad of [it]; the nearest known one is "
            "\"radius_m\", known: center_m, radius_m");
}

TEST(TomlSection, ExactlyOneOfTheKeysIsThere) {
  constexpr std::string_view kPlaces[] = {"box_m", "plane", "patch"};
  const auto only = [&](const std::string& text) {
    return std::string(SectionOfText(text).section.only_one_of(kPlaces));
  };
  EXPECT_EQ(only("plane = 1\nother = 2"), "plane");
  EXPECT_EQ(only("patch = 1"), "patch");
  EXPECT_EQ(refusal([&] {
              (void)only("other = 1");
            }),
            "a.toml:1: [it] needs one of the keys: box_m, plane, patch");
  EXPECT_EQ(refusal([&] {
              (void)only("patch = 1\nbox_m = 2");
            }),
            "a.toml:1: [it] has both box_m and patch, must have one of: box_m, plane, "
            "patch");
}

TEST(TomlSection, AKeyOfAnotherOwnerIsRefusedWithThoseThatTheOwnerHas) {
  constexpr std::string_view kOwn[] = {"mu_pa", "alpha"};
  constexpr std::string_view kShared[] = {"region"};
  const auto own = [&](const std::string& text) {
    return section_refusal(text, [&](const SceneSection& section) {
      section.require_own("law \"ogden\"", kOwn, kShared);
    });
  };
  EXPECT_EQ(own("region = 1\nalpha = 2\nmu_pa = 3"), "");
  EXPECT_EQ(own("region = 1\nc10_pa = 2"),
            "a.toml:2: \"c10_pa\" in [it] does not belong to law \"ogden\", which has: "
            "mu_pa, alpha");
}

}  // namespace
}  // namespace palpate

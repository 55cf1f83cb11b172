#include "formats/database/merge_shards.h"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/database/precision_choice.h"
#include "tests/support/run_tool.h"
#include "tests/support/sample_units.h"
#include "tests/support/small_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class MergeShards : public testing::Test {
 protected:
  // A shard of some of the sample's units.
  fs::path shard(const std::string& name, const std::vector<std::size_t>& units,
                 const std::string& digest = "0123abcd") {
    Shard shard{sample_plan(), {}};
    shard.plan.digest = digest;
    for (const std::size_t i : units) {
      shard.unit.push_back(sample_units()[i]);
    }
    write_shard(folder_ / name, shard);
    return folder_ / name;
  }
  static std::string refusal(const std::vector<fs::path>& files) {
    try {
      (void)merge_shards(files, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  [[nodiscard]] ToolRun merge(const std::vector<fs::path>& files) const {
    std::vector<std::string> arguments{"merge"};
    for (const fs::path& file : files) {
      arguments.push_back(file.string());
    }
    arguments.insert(arguments.end(), {"-o", (folder_ / "out.h5").string()});
    return run_tool_process("palpate-db", arguments);
  }
  ScratchFolder folder_;
};

TEST_F(MergeShards, GivesTheBytesOfTheWhole) {
  const ToolRun run = merge({shard("b", {1}), shard("a", {2, 0})});
  EXPECT_EQ(run.exit_code, 0) << run.err;  // as a build with a failed node
  ResponseDatabase whole = assemble(sample_plan(), sample_units(), {}).database;
  choose_precision(whole, {});
  write_database(folder_ / "whole.h5", whole);
  EXPECT_TRUE(bytes_of(folder_ / "out.h5") == bytes_of(folder_ / "whole.h5"));
}

TEST_F(MergeShards, RefusesShardsOfDifferentComputations) {
  const std::string says = refusal({shard("a", {0, 1}), shard("b", {2}, "another")});
  EXPECT_NE(says.find("different computations"), std::string::npos) << says;
}

TEST_F(MergeShards, NamesMissingUnits) {
  EXPECT_EQ(refusal({shard("a", {0}), shard("b", {2})}), "1 of 3 units are missing: 1");
}

TEST_F(MergeShards, NamesBothFilesOfAUnitThatComesTwice) {
  const std::string says = refusal({shard("a", {0, 1}), shard("b", {1, 2})});
  EXPECT_EQ(says.rfind("unit 1 comes twice", 0), 0U) << says;
  EXPECT_NE(says.find((folder_ / "a").string()), std::string::npos) << says;
  EXPECT_NE(says.find((folder_ / "b").string()), std::string::npos) << says;
}

TEST_F(MergeShards, RefusesAMixOfShardsAndDatabases) {
  write_database(folder_ / "other.h5", small_database());
  const ToolRun run = merge({shard("a", {0, 1, 2}), folder_ / "other.h5"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("other.h5 is no shard"), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(folder_ / "out.h5"));
}

TEST_F(MergeShards, RefusesADamagedShardAndLeavesNothing) {
  const fs::path damaged = shard("b", {2});
  fs::resize_file(damaged, fs::file_size(damaged) - 7);
  const ToolRun run = merge({shard("a", {0, 1}), damaged});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("is damaged"), std::string::npos) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_FALSE(fs::exists(folder_ / "out.h5"));
}

}  // namespace
}  // namespace palpate

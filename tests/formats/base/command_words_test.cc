#include "formats/base/command_words.h"

#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using Words = std::vector<std::string>;

class CommandWordsTest : public ::testing::Test {
 protected:
  Words with(const std::string& config, Words given) {
    std::ofstream(folder_ / "presets.toml") << config;
    given.push_back("--config");
    given.push_back((folder_ / "presets.toml").string());
    return command_words(given).word;
  }

  ScratchFolder folder_;
};

TEST_F(CommandWordsTest, ALineWithoutPresetsIsKept) {
  const Words given{"simulate", "a.h5", "--seconds", "3", "-o", "b.h5", "--json"};
  const CommandWords line = command_words(given);
  EXPECT_EQ(line.word, given);
  EXPECT_TRUE(line.note.empty());
}

TEST_F(CommandWordsTest, OldNamesAnswerAndSayTheNewOne) {
  const CommandWords line =
      command_words(Words{"build", "--workers", "2", "--patience=3", "--workersome"});
  EXPECT_EQ(line.word,
            (Words{"build", "--threads", "2", "--patience-s=3", "--workersome"}));
  ASSERT_EQ(line.note.size(), 2U);
  EXPECT_NE(line.note[0].find("--workers is --threads now"), std::string::npos);
}

TEST_F(CommandWordsTest, PresetsComeAfterTheLineAndBehindIt) {
  EXPECT_EQ(with("seconds = 2\nmodel = \"potential\"\njson = true\nresume = false\n",
                 {"simulate", "a.h5", "--seconds=3"}),
            (Words{"simulate", "a.h5", "--seconds=3", "--json", "--model=potential"}));
  EXPECT_EQ(with("output = \"c.h5\"", {"build", "-o", "b.h5"}),
            (Words{"build", "-o", "b.h5"}));
  EXPECT_EQ(with("friction = 0.25", {"simulate"}),
            (Words{"simulate", "--friction=0.25"}));
}

TEST_F(CommandWordsTest, TheVerbsOwnTableGoesBeforeTheOthers) {
  EXPECT_EQ(with("seconds = 2\n[simulate]\nseconds = 5\n[view]\nport = 8000\n",
                 {"simulate", "a.h5"}),
            (Words{"simulate", "a.h5", "--seconds=5"}));
}

TEST_F(CommandWordsTest, ALetterOfTheLineGoesBeforeTheFile) {
  EXPECT_EQ(with("sets = 9\n[pairs]\nsets = 8\n", {"pairs", "-n", "4"}),
            (Words{"pairs", "-n", "4"}));
  EXPECT_EQ(with("sets = 9\n", {"pairs", "-n4"}), (Words{"pairs", "-n4"}));
  EXPECT_EQ(with("output = \"c.h5\"\n", {"build", "-ob.h5"}),
            (Words{"build", "-ob.h5"}));
  EXPECT_EQ(with("sets = 9\n", {"pairs", "-o", "n"}),
            (Words{"pairs", "-o", "n", "--sets=9"}));
}

TEST_F(CommandWordsTest, ATableOfNoVerbIsRefusedWithTheNearest) {
  try {
    with("[bulid]\nthreads = 2\n", {"build"});
    ADD_FAILURE() << "[bulid] passed";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("presets.toml: [bulid]"), std::string::npos) << text;
    EXPECT_NE(text.find("nearest is [build]"), std::string::npos) << text;
    EXPECT_NE(text.find("simulate"), std::string::npos) << text;
  }
  EXPECT_THROW(with("[build.again]\nthreads = 2\n", {"build"}), InputError);
}

TEST_F(CommandWordsTest, AnArrayGivesSeveralValues) {
  EXPECT_EQ(with("at = [0.1, 0.0, -0.2]\n", {"simulate"}),
            (Words{"simulate", "--at", "0.1", "0", "-0.2"}));
}

TEST_F(CommandWordsTest, OldNamesInPresetsAnswerToo) {
  EXPECT_EQ(with("workers = 2\n", {"build"}), (Words{"build", "--threads=2"}));
}

TEST_F(CommandWordsTest, WhatIsNoPresetIsRefusedByName) {
  EXPECT_THROW(with("at = 1979-05-27\n", {"simulate"}), InputError);
  EXPECT_THROW(with("at = [[1, 2]]\n", {"simulate"}), InputError);
  EXPECT_THROW(with("at =\n", {"simulate"}), InputError);
  EXPECT_THROW(with("config = \"b.toml\"\n", {"simulate"}), InputError);
  EXPECT_THROW((void)command_words(Words{"build", "--config"}), InputError);
  EXPECT_THROW((void)command_words(Words{"build", "--config", "/nowhere.toml"}),
               InputError);
}

TEST_F(CommandWordsTest, AToolTakesThem) {
  std::ofstream(folder_ / "presets.toml") << "json = true\n[diff]\nworst = 3\n";
  const std::string config = "--config=" + (folder_ / "presets.toml").string();
  const ToolRun run = run_tool_process("palpate-db", {"info", "/nowhere.h5", config});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("/nowhere.h5"), std::string::npos) << run.err;
  std::ofstream(folder_ / "presets.toml") << "colour = 1\n";
  const ToolRun wrong = run_tool_process("palpate-db", {"info", "/nowhere.h5", config});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("--colour=1"), std::string::npos) << wrong.err;
}

}  // namespace
}  // namespace palpate

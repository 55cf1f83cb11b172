#include "formats/front/verbs.h"

#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "formats/base/command_words.h"
#include "tests/support/run_tool.h"

namespace palpate {
namespace {

// Subcommands by a tool's own help.
std::set<std::string> commands_of(const std::string& tool) {
  const std::string help = run_tool_process(tool, {"--help"}).out;
  std::set<std::string> names;
  std::size_t at = help.find("Subcommands:\n");
  while ((at = help.find("\n  ", at)) != std::string::npos) {
    at += 3;
    if (help[at] != ' ') {
      names.insert(help.substr(at, help.find(' ', at) - at));
    }
  }
  return names;
}

TEST(Verbs, AreTheToolsOwnAndNoneIsMissing) {
  for (const std::string tool : {"palpate-precompute", "palpate-run"}) {
    std::set<std::string> listed;
    for (const Verb& verb : kVerbs) {
      if (verb.tool == tool) {
        listed.insert(std::string(verb.command));
      }
    }
    EXPECT_EQ(listed, commands_of(tool)) << tool;
  }
  for (const std::string tool : {"palpate-fit", "palpate-db"}) {
    const Verb* verb = find_verb(tool.substr(tool.find('-') + 1));
    ASSERT_NE(verb, nullptr);
    EXPECT_EQ(verb->tool, tool);
    for (const std::string& name : commands_of(tool)) {
      const bool told = name == "bench" || tool == "palpate-fit" ||
                        verb->what.find(name) != std::string_view::npos;
      EXPECT_TRUE(told) << name;
    }
  }
}

TEST(Verbs, AreTheTablesOfOptionsAndNoOthers) {
  std::set<std::string> of_tools;
  for (const std::string tool :
       {"palpate-precompute", "palpate-fit", "palpate-db", "palpate-run"}) {
    of_tools.merge(commands_of(tool));
  }
  EXPECT_EQ(
      std::set<std::string>(std::begin(kTablesOfOptions), std::end(kTablesOfOptions)),
      of_tools);
}

// Every "-x,--name" of the helps is one of kLetteredOptions.
TEST(Verbs, HaveNoLettersThatPresetsDoNotKnow) {
  std::set<std::string> of_tools;
  const std::regex lettered("-([a-gi-z]),\\s*(--[a-z-]+)");
  for (const std::string tool :
       {"palpate-precompute", "palpate-fit", "palpate-db", "palpate-run"}) {
    for (const std::string& command : commands_of(tool)) {
      const std::string help = run_tool_process(tool, {command, "--help"}).out;
      for (std::sregex_iterator at(help.begin(), help.end(), lettered), end; at != end;
           ++at) {
        of_tools.insert((*at)[2].str() + " " + (*at)[1].str());
      }
    }
  }
  std::set<std::string> known;
  for (const LetteredOption& option : kLetteredOptions) {
    known.insert(std::string(option.name) + " " + option.letter);
  }
  EXPECT_EQ(known, of_tools);
}

TEST(Verbs, TakeOptionsByTheirNewNamesAlone) {
  std::string words;
  for (const std::string tool :
       {"palpate-precompute", "palpate-fit", "palpate-db", "palpate-run"}) {
    words += run_tool_process(tool, {"--completion"}).out;
  }
  for (const RenamedOption& option : kRenamedOptions) {
    EXPECT_NE(words.find(" " + std::string(option.now) + " "), std::string::npos);
    EXPECT_EQ(words.find(" " + std::string(option.before) + " "), std::string::npos);
  }
}

TEST(Verbs, AnErrorNamesTheVerbsOwnHelp) {
  const ToolRun run = run_tool_process("palpate", {"db", "info"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("(see palpate-db info --help)"), std::string::npos) << run.err;
}

TEST(Verbs, NoneStandsTwice) {
  for (const Verb& verb : kVerbs) {
    EXPECT_EQ(find_verb(verb.name), &verb) << verb.name;
  }
}

TEST(Verbs, ADatabaseIsCheckedByItsOwnTool) {
  const Verb* check = find_verb("check");
  ASSERT_NE(check, nullptr);
  using Line = std::vector<const char*>;
  EXPECT_EQ(tool_for(*check, Line{"organ.h5"}), "palpate-db");
  EXPECT_EQ(tool_for(*check, Line{"--json", "organ.h5"}), "palpate-db");
  EXPECT_EQ(tool_for(*check, Line{"organ.palpate"}), "palpate-db");
  EXPECT_EQ(tool_for(*check, Line{"organ.obj", "--repair", "safe"}),
            "palpate-precompute");
  EXPECT_EQ(tool_for(*check, Line{}), "palpate-precompute");
  EXPECT_EQ(tool_for(*find_verb("view"), Line{"organ.h5"}), "palpate-run");
}

TEST(Front, BecomesTheTool) {
  const ToolRun run = run_tool_process("palpate", {"db", "info", "/nowhere.h5"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("palpate-db: error: /nowhere.h5"), std::string::npos)
      << run.err;
  const ToolRun check = run_tool_process("palpate", {"check", "/nowhere.h5"});
  EXPECT_NE(check.err.find("palpate-db: error: /nowhere.h5"), std::string::npos)
      << check.err;
  const ToolRun view = run_tool_process("palpate", {"view", "--help"});
  EXPECT_EQ(view.exit_code, 0);
  EXPECT_NE(view.out.find("--port"), std::string::npos);
}

TEST(Front, SaysWhatThereIs) {
  const ToolRun help = run_tool_process("palpate", {"--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const Verb& verb : kVerbs) {
    const std::string line = "\n  " + std::string(verb.name) + " ";
    EXPECT_EQ(help.out.find(line) != std::string::npos, !verb.group.empty()) << line;
  }
  EXPECT_EQ(run_tool_process("palpate", {}).exit_code, 2);
  const ToolRun wrong = run_tool_process("palpate", {"biuld", "a.toml"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("the nearest is build"), std::string::npos) << wrong.err;
}

}  // namespace
}  // namespace palpate

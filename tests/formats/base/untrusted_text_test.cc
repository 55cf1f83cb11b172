// Files and texts that come from outside: pipes, endless keys, escapes.
#include <chrono>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/printable.h"
#include "formats/base/toml_text.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

std::string refusal(const std::filesystem::path& file, std::size_t most = 100) {
  try {
    (void)read_file(file, most, "a note");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(InputFile, IsReadWholeOrRefusedWithItsReason) {
  const ScratchFolder folder;
  const std::string text("a\0b\n", 4);
  std::ofstream(folder / "a", std::ios::binary) << text;
  EXPECT_EQ(read_file(folder / "a"), text);
  const auto says = [&](const std::filesystem::path& file, const char* what) {
    const std::string why = refusal(file, 3);
    EXPECT_NE(why.find(what), std::string::npos) << why;
  };
  says(folder / "absent", "no such file");
  says(folder / "a", "larger than 3 bytes, must be a note");
  says(folder / ".", "it is a folder");
  says("/dev/zero", "not a regular file");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  says(folder / "pipe", "not a regular file");  // and does not wait for a writer
}

std::string toml_refusal(const std::string& text) {
  try {
    (void)parse_toml(text, "a.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// 50 000 parts end the parser's stack.
TEST(TomlText, AKeyOfEndlessPartsIsRefusedWhereverItStands) {
  std::string key = "a";
  for (int i = 0; i < 50'000; ++i) {
    key += i % 3 == 0 ? ".a" : i % 3 == 1 ? " . \"x.y\"" : ".\t'b'";
  }
  for (const std::string& text : {key + " = 1\n", "x = 1\n[" + key + "]\n",
                                  "x = {" + key + " = 1}\n", "[[" + key + "]]\n"}) {
    EXPECT_NE(toml_refusal(text).find("a.toml:"), std::string::npos);
    EXPECT_NE(toml_refusal(text).find("more than 64 parts"), std::string::npos);
  }
}

TEST(TomlText, DotsElsewhereAreNoParts) {
  std::string many = "# a.b";
  for (int i = 0; i < 100; ++i) {
    many += ".c";
  }
  const std::string dots(200, '.');
  many += "\nnumbers = [";
  for (int i = 0; i < 100; ++i) {
    many += "1.5, ";
  }
  many += "2.5]\n";
  many += fmt::format("text = \"{}\\\"{}\"\n", dots, dots);
  many += fmt::format("raw = '{}'\n", dots);
  many += fmt::format("long = \"\"\"\n{}\n\"\"\"\na.b.c = 1.25\n", dots);
  EXPECT_EQ(toml_refusal(many), "");
  EXPECT_EQ(parse_toml(many, "a.toml")["a"]["b"]["c"].value_or(0.0), 1.25);
}

TEST(TomlText, AMistakeIsNamedWithItsLine) {
  EXPECT_EQ(toml_refusal("a = 1\nb = \n").rfind("a.toml:2: is not TOML: ", 0), 0U)
      << toml_refusal("a = 1\nb = \n");
}

TEST(Printable, WhatATerminalWouldObeyIsShown) {
  EXPECT_EQ(printable("\x1b[2Jliver\a"), "\\x1b[2Jliver\\x07");
  EXPECT_EQ(printable("a\tb\n"), "a\tb\n");
  EXPECT_EQ(printable("\xc2\x9b"), "\\xc2\\x9b");  // CSI as one character
  EXPECT_EQ(printable("Leber \xc3\xa4 \xe2\x82\xac \xf0\x9f\x98\x80"),
            "Leber \xc3\xa4 \xe2\x82\xac \xf0\x9f\x98\x80");
  for (const char* wrong :
       {"\xff", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80"}) {
    EXPECT_EQ(printable(wrong).find("\\x"), 0U) << printable(wrong);
  }
}

}  // namespace
}  // namespace palpate

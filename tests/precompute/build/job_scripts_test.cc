// The scripts of a shared-out build, run by a real shell with stand-ins for the tools:
// what they do when a machine fails.
#include "precompute/build/job_scripts.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "formats/base/error.h"
#include "formats/base/sha256.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

int shell(const std::string& line) {
  const int status = std::system(line.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// build writes its shard's number; merge puts the files together. `trouble` is a line
// of shell that the build runs first, with $4 = OUTPUT and the count of its attempts.
class JobScripts : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(place_);
    write(place_ / "scene.toml", "scene");
    job_.scene = place_ / "scene.toml";
    job_.output = place_ / "out.h5";
    job_.folder = place_ / "jobs";
    job_.tools = place_;
    job_.input = {{job_.scene, sha256_of_file(job_.scene)}};
    job_.shards = 3;
    job_.at_once = 2;
    build_does(":");
    tool("palpate-db", "cat $2 $3 $4 > \"$6\"");
  }
  void tool(const std::string& name, const std::string& text) {
    write(place_ / name, "#!/bin/bash\n" + text + "\n");
    fs::permissions(place_ / name, fs::perms::owner_all);
  }
  void build_does(const std::string& trouble) {
    tool("palpate-precompute",
         "echo x >> $4.attempts; attempts=$(wc -l < $4.attempts)\n" + trouble +
             "\necho $6 > $4");
  }
  int start() {
    write_job(job_);
    return shell("bash " + shell_word((job_.folder / "start.sh").string()) + " > " +
                 shell_word((place_ / "log").string()) + " 2>&1");
  }
  std::string attempts(int shard) {
    return bytes_of(job_.folder / fmt::format("shard-{}.attempts", shard));
  }

  ScratchFolder scratch_;
  fs::path place_ = scratch_ / "it's a $HOME \"place\"";
  Job job_;
};

TEST_F(JobScripts, EveryShardIsBuiltOnceAndMergedInOrder) {
  EXPECT_EQ(start(), 0) << bytes_of(place_ / "log");
  EXPECT_EQ(bytes_of(job_.output), "0/3\n1/3\n2/3\n");
  EXPECT_EQ(attempts(1), "x\n");
}

TEST_F(JobScripts, ShardsThatAreThereAreNotBuiltAgain) {
  ASSERT_EQ(start(), 0);
  fs::remove(job_.output);
  EXPECT_EQ(start(), 0);
  EXPECT_EQ(bytes_of(job_.output), "0/3\n1/3\n2/3\n");
  EXPECT_EQ(attempts(0), "x\n");
}

TEST_F(JobScripts, KilledShardIsTriedAgainAndNoOther) {
  build_does("if [ $4 = shard-1 ] && ((attempts < 3)); then kill -9 $$; fi");
  EXPECT_EQ(start(), 0) << bytes_of(place_ / "log");
  EXPECT_EQ(bytes_of(job_.output), "0/3\n1/3\n2/3\n");
  EXPECT_EQ(attempts(1), "x\nx\nx\n");
  EXPECT_EQ(attempts(2), "x\n");
}

TEST_F(JobScripts, ShardThatNeverEndsWellIsNamed) {
  build_does("if [ $4 = shard-1 ]; then kill -9 $$; fi");
  EXPECT_EQ(start(), 75);
  EXPECT_EQ(attempts(1), "x\nx\nx\n");
  EXPECT_NE(bytes_of(place_ / "log").find("shards 1 are missing"), std::string::npos);
  EXPECT_FALSE(fs::exists(job_.output));
}

TEST_F(JobScripts, WrongInputIsNotTriedAgain) {
  build_does("if [ $4 = shard-2 ]; then exit 3; fi");
  EXPECT_EQ(start(), 3);
  EXPECT_EQ(attempts(2), "x\n");
  EXPECT_NE(bytes_of(place_ / "log").find("shard 2 failed"), std::string::npos);
  build_does(":");  // mended: the next start takes it up
  EXPECT_EQ(start(), 0) << bytes_of(place_ / "log");
}

TEST_F(JobScripts, SceneThatChangedSinceIsRefused) {
  write_job(job_);
  write(job_.scene, "another scene");
  EXPECT_EQ(shell("bash " + shell_word((job_.folder / "start.sh").string()) +
                  " > /dev/null 2>&1"),
            2);
  EXPECT_EQ(attempts(0), "");
}

TEST_F(JobScripts, AnotherCopyOfATaskThatWasFasterIsNoFailure) {
  build_does("if [ $4 = shard-0 ]; then echo 0/3 > $4; exit 2; fi");
  EXPECT_EQ(start(), 0) << bytes_of(place_ / "log");
}

// serve SCENE -o OUTPUT --socket SOCKET ...: the last service writes the output.
class JobServices : public JobScripts {
 protected:
  void SetUp() override {
    JobScripts::SetUp();
    job_.serve = true;
    job_.shards = 2;
    serve_does(":");
  }
  void serve_does(const std::string& trouble) {
    tool("palpate-precompute", "echo \"$6\" >> \"$4.sockets\"; " + trouble +
                                   "\n[ \"$1\" = serve ] && echo whole > \"$4\"");
  }
  std::string sockets() const { return bytes_of(job_.output.string() + ".sockets"); }
};

TEST_F(JobServices, EachHasASocketOfItsOwn) {
  EXPECT_EQ(start(), 0) << bytes_of(place_ / "log");
  EXPECT_EQ(bytes_of(job_.output), "whole\n");
  const std::string all = sockets();
  const std::string first = all.substr(0, all.find('\n'));
  EXPECT_NE(first.find("palpate.socket"), std::string::npos) << all;
  EXPECT_NE(all, first + "\n" + first + "\n");
  EXPECT_FALSE(fs::exists(fs::path(first).parent_path()));
  EXPECT_EQ(start(), 0);  // they find out themselves that all is done
  EXPECT_NE(sockets(), all);
}

TEST_F(JobServices, AreStartedAgainUntilTheOutputIsThere) {
  serve_does("if (($(wc -l < \"$4.sockets\") < 4)); then kill -9 $$; fi");
  EXPECT_EQ(start(), 0) << bytes_of(place_ / "log");
  EXPECT_EQ(bytes_of(job_.output), "whole\n");
}

TEST_F(JobServices, OutputOfAnotherSceneIsNoSuccess) {
  write(job_.output, "of another scene");
  serve_does("exit 2");
  EXPECT_EQ(start(), 2);
  EXPECT_EQ(bytes_of(job_.output), "of another scene");
  serve_does("kill -9 $$");
  fs::remove(job_.output);
  EXPECT_EQ(start(), 75);
}

TEST(JobScriptsDigest, TellsInputsFlagsAndShardsApart) {
  Job job;
  job.input = {{"/a", "1"}, {"/b", "2"}};
  const std::string same = job_digest(job);
  EXPECT_EQ(same.size(), 12U);
  job.output = "/elsewhere";
  job.merge_flags = {"--precision", "int16"};
  EXPECT_EQ(job_digest(job), same);
  Job other = job;
  other.input[1].second = "3";
  EXPECT_NE(job_digest(other), same);
  other = job;
  other.shards = 4;
  EXPECT_NE(job_digest(other), same);
  other = job;
  other.build_flags = {"--solve-all"};
  EXPECT_NE(job_digest(other), same);
  other = job;
  other.serve = true;
  EXPECT_NE(job_digest(other), same);
}

TEST(JobScriptsTime, LimitIsThreeTimesTheShareAndTenMinutes) {
  EXPECT_EQ(time_limit_minutes(0.0, 4), 10);
  EXPECT_EQ(time_limit_minutes(8000.0, 4), 10 + 100);
  EXPECT_EQ(time_limit_minutes(1.0, 4), 11);
}

TEST(JobScriptsEngine, OnlyTwoAreKnown) {
  EXPECT_EQ(job_engine("slurm"), JobEngine::kSlurm);
  EXPECT_EQ(job_engine("local"), JobEngine::kLocal);
  EXPECT_THROW(static_cast<void>(job_engine("Slurm")), InputError);
}

}  // namespace
}  // namespace palpate

#include "runtime/served/service_process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "tests/support/comes_true.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;

TEST(ServiceProcess, IsFoundStartedAndEndedByATerm) {
  const ScratchFolder folder;
  const auto program = folder / "server";
  std::ofstream(program) << "#!/bin/sh\ntrap 'echo ended > '"
                         << (folder / "said").string()
                         << "'; exit 0' TERM\necho \"$@\" > "
                         << (folder / "asked").string()
                         << "\nwhile :; do sleep 0.01; done\n";
  EXPECT_THROW((void)find_server(program), InputError);
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  EXPECT_EQ(find_server(program), program);
  EXPECT_EQ(find_server("").filename(), "palpate-precompute");
  {
    ServiceProcess process({.program = program,
                            .scene = "a.toml",
                            .output = served_output("x/a.toml"),
                            .anew = true});
    ASSERT_TRUE(comes_true(
        [&] {
          return std::filesystem::exists(folder / "asked");
        },
        milliseconds(5000)));
    errno = ECHILD;  // of somebody else
    EXPECT_FALSE(process.exit_code());
  }
  std::string asked;
  std::getline(std::ifstream(folder / "asked") >> std::ws, asked);
  EXPECT_EQ(asked,
            "serve a.toml -o a.h5 --with " + std::to_string(::getpid()) + " --anew");
  EXPECT_TRUE(std::filesystem::exists(folder / "said"));
  ServiceProcess fails({.program = "/bin/false", .scene = "a", .output = "b"});
  EXPECT_TRUE(comes_true(
      [&] {
        return fails.exit_code() == 1;
      },
      milliseconds(5000)));
}

// A host that has the system reap its children learns nothing of their codes.
TEST(ServiceProcess, HasEndedWhereTheHostIgnoresItsChildren) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  {
    ServiceProcess fails({.program = "/bin/false", .scene = "a", .output = "b"});
    EXPECT_TRUE(comes_true(
        [&] {
          return fails.exit_code() == ServiceProcess::kReapedElsewhere;
        },
        milliseconds(5000)));
  }
  std::signal(SIGCHLD, before);
}

TEST(ServiceProcess, HasNoFileOpenButItsStreams) {
  const ScratchFolder folder;
  const auto program = folder / "server";
  const std::string open_files = (folder / "open").string();
  std::ofstream(program) << "#!/bin/sh\nls /proc/$$/fd > " << open_files << ".all\nmv "
                         << open_files << ".all " << open_files << "\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const int inherited = ::open("/dev/null", O_RDONLY);
  const int high = ::fcntl(inherited, F_DUPFD, 77);
  const ServiceProcess process({.program = program, .scene = "a", .output = "b"});
  ASSERT_TRUE(comes_true(
      [&] {
        return std::filesystem::exists(open_files);
      },
      milliseconds(5000)));
  ::close(inherited);
  ::close(high);
  const std::string all = read_file(open_files);
  EXPECT_EQ(all.find("77"), std::string::npos) << all;
}

}  // namespace
}  // namespace palpate

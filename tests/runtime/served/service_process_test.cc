#include "runtime/served/service_process.h"

#include <chrono>
#include <fstream>

#include <gtest/gtest.h>

#include "formats/base/error.h"
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
    EXPECT_FALSE(process.exit_code());
  }
  std::string asked;
  std::getline(std::ifstream(folder / "asked") >> std::ws, asked);
  EXPECT_EQ(asked, "serve a.toml -o a.h5 --anew");
  EXPECT_TRUE(std::filesystem::exists(folder / "said"));
  ServiceProcess fails({.program = "/bin/false", .scene = "a", .output = "b"});
  EXPECT_TRUE(comes_true(
      [&] {
        return fails.exit_code() == 1;
      },
      milliseconds(5000)));
}

}  // namespace
}  // namespace palpate

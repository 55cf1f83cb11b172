// A writer that dies at any moment leaves the old file or the new one.
#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/database/response_database.h"
#include "tests/support/quiet_exit.h"
#include "tests/support/sphere_database.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(KilledWriter, LeavesTheOldFileOrTheNewOne) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  ResponseDatabase database = sphere_database(24, 17);
  const auto start = std::chrono::steady_clock::now();
  write_database(file, database);
  const std::chrono::duration<double> takes = std::chrono::steady_clock::now() - start;
  const std::string old_bytes = bytes_of(file);
  database.provenance.left_out = "the new one";
  write_database(file, database);
  const std::string new_bytes = bytes_of(file);

  std::mt19937 random(5);
  std::uniform_real_distribution<double> moment(0.0, 1.2 * takes.count());
  int unfinished = 0;
  for (int i = 0; i < 50; ++i) {
    std::ofstream(file, std::ios::binary) << old_bytes;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      write_database(file, database);
      ::_exit(0);
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::string bytes = bytes_of(file);
    ASSERT_TRUE(bytes == old_bytes || bytes == new_bytes) << "kill " << i;
    unfinished += bytes == old_bytes;
  }
  std::printf("50 kills while writing: %d times the old file, %d times the new one\n",
              unfinished, 50 - unfinished);
}

}  // namespace
}  // namespace palpate

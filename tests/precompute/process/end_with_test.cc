#include "precompute/process/end_with.h"

#include <array>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

// Its signal in a child that ended itself so; else its exit code.
int ended_by(pid_t child) {
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
}

TEST(EndWith, EndsWhenTheOtherIsKilledWhicheverThreadBeganIt) {
  const pid_t other = fork();
  if (other == 0) {
    pause();
    _exit(0);
  }
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  pid_t child = 0;
  std::thread([&] {  // gone before the other process is
    child = fork();
    if (child == 0) {
      end_with(other);
      (void)!write(ends[1], "x", 1);
      pause();
      _exit(7);
    }
  })
      .join();
  char byte = 0;
  ASSERT_EQ(read(ends[0], &byte, 1), 1);
  EXPECT_EQ(waitpid(child, nullptr, WNOHANG), 0);
  kill(other, SIGKILL);
  EXPECT_EQ(ended_by(other), SIGKILL);
  EXPECT_EQ(ended_by(child), SIGTERM);
  close(ends[0]);
  close(ends[1]);
}

TEST(EndWith, EndsAtOnceWhereTheOtherIsGone) {
  const pid_t other = fork();
  if (other == 0) {
    _exit(0);
  }
  EXPECT_EQ(ended_by(other), 0);
  const pid_t child = fork();
  if (child == 0) {
    end_with(other);
    pause();
    _exit(7);
  }
  EXPECT_EQ(ended_by(child), SIGTERM);
}

}  // namespace
}  // namespace palpate

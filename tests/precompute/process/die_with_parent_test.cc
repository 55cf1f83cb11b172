#include "precompute/process/die_with_parent.h"

#include <csignal>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

TEST(DieWithParent, GoesOnWhileTheParentLives) {
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    die_with_parent(parent);
    _exit(7);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

// The end of a pipe that a grandchild holds is closed when it is gone.
TEST(DieWithParent, EndsWhereTheParentEndedBeforeItCouldAsk) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    const pid_t parent = getpid();
    if (fork() == 0) {
      while (getppid() == parent) {
        usleep(1000);
      }
      die_with_parent(parent);
      const char outlived = 'x';
      (void)!write(ends[1], &outlived, 1);
      _exit(0);
    }
    _exit(0);
  }
  close(ends[1]);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

}  // namespace
}  // namespace palpate

#include "runtime/realtime/real_time.h"

#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

namespace palpate {
namespace {

// The first CPU that this thread may use.
int first_cpu() {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  pthread_getaffinity_np(pthread_self(), sizeof cpus, &cpus);
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &cpus)) {
      return cpu;
    }
  }
  return -1;
}

// In threads of their own: what is granted ends with them, but for locked memory.
TEST(RequestRealTime, SaysWhatIsGrantedAndWhatIsNotAndWhy) {
  const int cpu = first_cpu();
  std::thread([&] {
    const RealTimeGrant grant = request_real_time(cpu);
    const bool fifo = sched_getscheduler(0) == SCHED_FIFO;
    EXPECT_EQ(grant.fifo_scheduling, fifo);
    EXPECT_EQ(grant.remark.find("no SCHED_FIFO (") == std::string::npos, fifo);
    EXPECT_EQ(grant.remark.find("memory not locked (") == std::string::npos,
              grant.memory_locked);
    EXPECT_TRUE(grant.pinned) << grant.remark;
    EXPECT_EQ(first_cpu(), cpu);
    EXPECT_NE(grant.remark.find(", on CPU " + std::to_string(cpu)), std::string::npos);
    EXPECT_EQ(grant.remark.find('\n'), std::string::npos);
  }).join();
}

TEST(RequestRealTime, LeavesTheThreadFreeWithoutACpuAndWhereThereIsNone) {
  std::thread([] {
    const int before = first_cpu();
    EXPECT_NE(request_real_time().remark.find(", on any CPU"), std::string::npos);
    for (const int cpu : {1'000'000, CPU_SETSIZE - 1}) {
      const RealTimeGrant grant = request_real_time(cpu);
      EXPECT_FALSE(grant.pinned);
      EXPECT_NE(grant.remark.find("not kept on CPU"), std::string::npos);
    }
    EXPECT_EQ(first_cpu(), before);
  }).join();
}

}  // namespace
}  // namespace palpate

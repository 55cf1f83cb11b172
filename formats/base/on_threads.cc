#include "formats/base/on_threads.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace palpate {

unsigned thread_count(unsigned wanted) noexcept {
  return wanted > 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

void on_threads(unsigned wanted, std::size_t count,
                const std::function<void(std::size_t)>& body) {
  std::atomic<std::size_t> next{0};
  std::mutex failing;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        body(i);
      } catch (...) {
        const std::scoped_lock lock(failing);
        failure = failure ? failure : std::current_exception();
        next = count;
      }
    }
  };
  {
    const std::size_t threads = std::min<std::size_t>(thread_count(wanted), count);
    std::vector<std::jthread> workers;
    for (std::size_t k = 1; k < threads; ++k) {
      workers.emplace_back(work);
    }
    work();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
}

}  // namespace palpate

#include "precompute/process/patience.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <optional>
#include <thread>

#include "formats/base/error.h"
#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

using WaitClock = std::chrono::steady_clock;
using Wait = std::chrono::duration<double>;

constexpr Wait kFirstPause{0.1};
constexpr Wait kLongestPause{5.0};
constexpr Wait kLook{0.1};  // for Ctrl-C

void pause_for(Wait pause) {
  const auto end = WaitClock::now() + pause;
  while (WaitClock::now() < end) {
    check_interrupted();
    std::this_thread::sleep_for(std::min(kLook, Wait(end - WaitClock::now())));
  }
}

}  // namespace

void with_patience(double patience_s, const std::string& whose,
                   const std::function<void()>& work) {
  std::optional<WaitClock::time_point> first;
  Wait pause = kFirstPause;
  while (true) {
    std::string want;
    try {
      work();
      return;
    } catch (const ResourceError& error) {
      want = error.what();
    } catch (const std::bad_alloc&) {
      want = whose + " needed more memory than there is";
    }
    const auto now = WaitClock::now();
    first = first.value_or(now);
    const Wait left = Wait(patience_s) - Wait(now - *first);
    if (!(left.count() > 0.0)) {
      throw ResourceError(want);
    }
    pause_for(std::min(pause, left));
    pause = std::min(2.0 * pause, kLongestPause);
  }
}

}  // namespace palpate

#include "precompute/process/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include "formats/base/stopwatch.h"
#include "precompute/process/interrupt.h"

namespace palpate {
namespace {

constexpr auto kRedraw = std::chrono::milliseconds(100);

}  // namespace

Progress::Progress(std::FILE* out)
    : out_(out), terminal_(out != nullptr && isatty(fileno(out)) != 0) {}

void Progress::stage(const std::string& name) {
  finish();
  check_interrupted();
  name_ = name;
  began_ = Clock::now();
  shown_ = began_;
  tenth_ = 0;
  if (out_ != nullptr && terminal_) {
    fmt::print(out_, "\r\033[K{} ...", name_);
    std::fflush(out_);
  }
}

void Progress::advance(std::size_t done, std::size_t total, const char* pieces) {
  check_interrupted();
  if (out_ == nullptr || done == 0 || done > total) {
    return;
  }
  const double elapsed = seconds_since(began_);
  const double rate = static_cast<double>(done) / std::max(elapsed, 1e-6);
  const double left = static_cast<double>(total - done) / rate;
  if (terminal_) {
    if (Clock::now() - shown_ >= kRedraw) {
      shown_ = Clock::now();
      fmt::print(out_, "\r\033[K{} {}/{} {}, {:.0f}/s, {:.0f} s left", name_, done,
                 total, pieces, rate, left);
      std::fflush(out_);
    }
  } else if (const std::size_t tenth = 10 * done / total;
             tenth > tenth_ && done < total) {
    tenth_ = tenth;
    fmt::print(out_, "{} {}/{} {}, {:.0f}/s, {:.0f} s left\n", name_, done, total,
               pieces, rate, left);
  }
}

void Progress::finish() {
  if (out_ != nullptr && !name_.empty()) {
    fmt::print(out_, "{}{}: {:.1f} s\n", terminal_ ? "\r\033[K" : "", name_,
               seconds_since(began_));
    std::fflush(out_);
  }
  name_.clear();
}

}  // namespace palpate

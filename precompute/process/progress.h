// What a long computation says while it runs, on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>

namespace palpate {

/// On a terminal one line that is written over, with rate and time left. Otherwise
/// plain lines, one per stage and one per tenth of a stage. Every call also looks for
/// Ctrl-C.
class Progress {
 public:
  /// @param out nullptr: silent.
  explicit Progress(std::FILE* out);

  /// Ends the stage before and starts one. @throws Interrupted.
  void stage(const std::string& name);

  /// `done` of `total` pieces of the current stage. @throws Interrupted.
  void advance(std::size_t done, std::size_t total, const char* pieces);

  /// Ends the last stage.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  std::FILE* out_;
  bool terminal_;
  std::string name_;
  Clock::time_point began_;
  Clock::time_point shown_;
  std::size_t tenth_ = 0;
};

}  // namespace palpate

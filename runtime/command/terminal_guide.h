// Leads the person at the terminal through a probe: what to do, time left, one key to
// stop.
#pragma once

#include <cstdint>

#include <termios.h>

#include "runtime/attach/probe.h"

namespace palpate {

/// While it lives, keys of a terminal come at once: q or Escape stop, Enter or space go
/// on. Without a terminal signals stop, and lines of standard input go on.
class TerminalGuide {
 public:
  TerminalGuide();
  ~TerminalGuide();
  TerminalGuide(const TerminalGuide&) = delete;
  TerminalGuide& operator=(const TerminalGuide&) = delete;

  /// Calls into this.
  [[nodiscard]] ProbeGuide guide();

 private:
  enum class Key : std::uint8_t { kNone, kGoOn, kStop };

  void say(const char* text);
  void await(const char* text);
  [[nodiscard]] Key key(int wait_ms);
  [[nodiscard]] bool stopped();

  bool keys_ = false;  // standard input is a terminal
  termios before_{};
  bool line_ = false;  // the time left stands on the last line
  bool stop_ = false;
};

}  // namespace palpate

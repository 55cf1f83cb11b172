#include "runtime/command/terminal_guide.h"

#include <string>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "formats/base/error.h"
#include "runtime/command/device_options.h"
#include "runtime/realtime/stop_signals.h"

namespace palpate {

TerminalGuide::TerminalGuide() : keys_(::isatty(STDIN_FILENO) == 1) {
  if (keys_ && ::tcgetattr(STDIN_FILENO, &before_) == 0) {
    termios keys = before_;
    keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C stays a signal
    ::tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  } else {
    keys_ = false;
  }
}

TerminalGuide::~TerminalGuide() {
  if (line_) {
    fmt::print(stderr, "\n");
  }
  if (keys_) {
    ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
}

TerminalGuide::Key TerminalGuide::key(int wait_ms) {
  constexpr char kEscape = 27;
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  char byte = 0;
  if (!keys_ || ::poll(&input, 1, wait_ms) <= 0) {
    return Key::kNone;
  }
  if (::read(STDIN_FILENO, &byte, 1) != 1 || byte == 'q' || byte == kEscape) {
    return Key::kStop;
  }
  return byte == '\n' || byte == ' ' ? Key::kGoOn : Key::kNone;
}

bool TerminalGuide::stopped() {
  stop_ = stop_ || stop_signals().load() || key(0) == Key::kStop;
  return stop_;
}

void TerminalGuide::say(const char* text) {
  fmt::print(stderr, "{}{}\n", line_ ? "\r\033[K" : "", text);
  line_ = false;
}

void TerminalGuide::await(const char* text) {
  if (!keys_) {
    ask_person(text);
    return;
  }
  constexpr int kLookMs = 100;
  say(fmt::format("{}; then press Enter (q: stop)", text).c_str());
  for (Key pressed = Key::kNone; pressed != Key::kGoOn; pressed = key(kLookMs)) {
    if (pressed == Key::kStop || stop_signals()) {
      throw Interrupted();
    }
  }
}

ProbeGuide TerminalGuide::guide() {
  ProbeGuide guide;
  guide.say = [this](const std::string& text) {
    say(text.c_str());
  };
  guide.await = [this](const std::string& text) {
    await(text.c_str());
  };
  guide.stopped = [this] {
    return stopped();
  };
  if (::isatty(STDERR_FILENO) == 1) {
    guide.progress = [this](double left_s) {
      fmt::print(stderr, "\r\033[K  about {:.0f} s left{}", left_s,
                 keys_ ? " (q: let go and stop)" : "");
      line_ = true;
    };
  }
  return guide;
}

}  // namespace palpate

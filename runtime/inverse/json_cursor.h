// A reader of JSON that walks over a text once: no allocation, no recursion deeper than
// kJsonDepthMax, nothing kept but what the caller takes.
//
// The grammar is RFC 8259's. Strings are handed out as they stand in the text, escapes
// and all: they are for comparison with names that need none. Bytes above 0x7F are
// passed over, not checked.
#pragma once

#include <charconv>
#include <cstddef>
#include <string_view>
#include <system_error>

namespace palpate {

constexpr int kJsonDepthMax = 32;

class JsonCursor {
 public:
  explicit JsonCursor(std::string_view text) : text_(text) {}

  /// Null while all was well; then the first thing that was not. Every call after that
  /// does nothing.
  [[nodiscard]] const char* failure() const noexcept { return failure_; }

  void fail(const char* why) noexcept {
    if (failure_ == nullptr) {
      failure_ = why;
    }
    at_ = text_.size();
  }

  /// Calls member(name) for each, which must take the value.
  template <typename Member>
  void object(const Member& member) noexcept {
    list('{', '}', [&] {
      const std::string_view name = string();
      if (take(':', "a name without a value")) {
        member(name);
      }
    });
  }

  /// Calls element() for each, which must take the value.
  template <typename Element>
  void array(const Element& element) noexcept {
    list('[', ']', element);
  }

  [[nodiscard]] std::string_view string() noexcept {
    if (!take('"', "something else where a string should be")) {
      return {};
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != '"') {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) {
        fail("a control character in a string");
        return {};
      }
      if (text_[at_] == '\\' && !escape()) {
        fail("an escape that does not exist");
        return {};
      }
      ++at_;
    }
    if (at_ >= text_.size()) {
      fail("a string without an end");
      return {};
    }
    return text_.substr(begin, at_++ - begin);
  }

  /// Finite; 0 after a failure.
  [[nodiscard]] double number() noexcept {
    space();
    const std::size_t begin = at_;
    at_ += peek() == '-' ? 1 : 0;
    const bool zero = peek() == '0';
    bool good = zero ? (++at_, true) : digits();
    if (peek() == '.') {
      ++at_;
      good = digits() && good;
    }
    if (peek() == 'e' || peek() == 'E') {
      ++at_;
      at_ += peek() == '-' || peek() == '+' ? 1 : 0;
      good = digits() && good;
    }
    double value = 0.0;
    if (failure_ == nullptr &&
        (!good || std::from_chars(text_.data() + begin, text_.data() + at_, value).ec !=
                      std::errc())) {
      fail("something else where a number should be");
    }
    return failure_ == nullptr ? value : 0.0;
  }

  [[nodiscard]] bool boolean() noexcept {
    space();
    const bool truth = word("true");
    if (!truth && !word("false")) {
      fail("something else where true or false should be");
    }
    return truth;
  }

  /// Passes over a value of any kind.
  void skip() noexcept {
    space();
    switch (peek()) {
      case '{':
        object([this](std::string_view) {
          skip();
        });
        return;
      case '[':
        array([this] {
          skip();
        });
        return;
      case '"':
        static_cast<void>(string());
        return;
      case 't':
      case 'f':
        static_cast<void>(boolean());
        return;
      case 'n':
        if (!word("null")) {
          fail("a word that does not exist");
        }
        return;
      default:
        static_cast<void>(number());
    }
  }

  /// Nothing but white space may be left.
  void end() noexcept {
    space();
    if (at_ < text_.size()) {
      fail("something after its end");
    }
  }

 private:
  [[nodiscard]] char peek() const noexcept {
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  void space() noexcept {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n' ||
                                  text_[at_] == '\t' || text_[at_] == '\r')) {
      ++at_;
    }
  }

  bool take(char wanted, const char* else_failure) noexcept {
    space();
    if (peek() != wanted || failure_ != nullptr) {
      fail(else_failure);
      return false;
    }
    ++at_;
    return true;
  }

  bool word(std::string_view wanted) noexcept {
    const bool there = text_.substr(at_, wanted.size()) == wanted;
    at_ += there ? wanted.size() : 0;
    return there;
  }

  [[nodiscard]] static bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

  bool digits() noexcept {
    const std::size_t begin = at_;
    while (is_digit(peek())) {
      ++at_;
    }
    return at_ > begin;
  }

  // At the backslash; stays at the last character of the escape.
  bool escape() noexcept {
    constexpr std::string_view kPlain = "\"\\/bfnrt";
    constexpr std::string_view kHex = "0123456789abcdefABCDEF";
    ++at_;
    if (kPlain.find(peek()) != std::string_view::npos && at_ < text_.size()) {
      return true;
    }
    const std::string_view code = text_.substr(at_, 5);
    at_ += 4;
    return code.size() == 5 && code[0] == 'u' &&
           code.find_first_not_of(kHex, 1) == std::string_view::npos;
  }

  template <typename Item>
  void list(char open, char close, const Item& item) noexcept {
    if (!take(open, open == '{' ? "something else where an object should be"
                                : "something else where a list should be")) {
      return;
    }
    if (++depth_ > kJsonDepthMax) {
      fail("more than 32 levels");
      return;
    }
    space();
    if (peek() == close) {
      ++at_;
      --depth_;
      return;
    }
    for (;;) {
      item();
      space();
      if (failure_ != nullptr || peek() != ',') {
        break;
      }
      ++at_;
    }
    take(close, "a list or object without an end");
    --depth_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  const char* failure_ = nullptr;
};

}  // namespace palpate

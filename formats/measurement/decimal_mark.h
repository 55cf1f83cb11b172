// Whether a comma or a point separates thousands cannot be distinguished from one cell:
// "1,234". It can where another cell of the table has the other mark, or none.
#pragma once

#include <cstddef>
#include <string>

namespace palpate {

class DecimalMark {
 public:
  /// @param file for messages; must outlive this.
  explicit DecimalMark(const std::string& file) : file_(file) {}

  /// A cell with a number. @throws FormatError where a mark separates thousands.
  void see(const std::string& cell, std::size_t line);

  /// After all cells. @throws FormatError where every comma may separate thousands:
  /// three digits stand behind each, and numbers of three digits have none.
  void check() const;

 private:
  struct Seen {
    std::size_t any = 0, grouped = 0, other = 0;  // line of the first such cell
  };
  const std::string& file_;
  Seen comma_, point_;
  std::size_t plain_ = 0;  // line of the first whole number of three digits
};

}  // namespace palpate

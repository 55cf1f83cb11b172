// nlohmann_json 3.11.2 asks for std::char_traits<unsigned char>, which is not in the
// standard; libc++ has it no more since version 19.
#pragma once

#include <string>

#ifdef _LIBCPP_VERSION
template <>
struct std::char_traits<unsigned char> {
  using char_type = unsigned char;
  using int_type = int;
  static constexpr int_type eof() noexcept { return -1; }
  static constexpr int_type to_int_type(char_type c) noexcept { return c; }
  static constexpr char_type to_char_type(int_type c) noexcept {
    return static_cast<char_type>(c);
  }
  static constexpr bool eq_int_type(int_type a, int_type b) noexcept { return a == b; }
};
#endif

#include_next <nlohmann/json.hpp>

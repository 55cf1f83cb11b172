// One table of a scene file: reads its keys and says, with file and line, where they
// are wrong. Only for scene*.cc.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <toml++/toml.h>

#include "formats/base/error.h"
#include "formats/mesh/surface_mesh.h"

namespace palpate {

using Names = std::span<const std::string_view>;

/// What a finite number must fulfil; NaN fulfils nothing.
struct NumberRule {
  bool (*holds)(double);
  const char* text;  ///< "positive and finite"
};

inline constexpr NumberRule kPositive{[](double v) {
                                        return v > 0.0;
                                      },
                                      "positive and finite"};
inline constexpr NumberRule kNotNegative{[](double v) {
                                           return v >= 0.0;
                                         },
                                         "zero or more and finite"};

/// Every method @throws InputError "scene.toml:12: ..." with the key, its value and
/// what is allowed.
class SceneSection {
 public:
  /// @param title  as a person writes it, "[body]"; file and table are kept by
  /// reference.
  SceneSection(const std::string& file, std::string title, const toml::table& table)
      : file_(file), title_(std::move(title)), table_(table) {}

  template <typename... Values>
  [[noreturn]] void fail(const toml::node& where, fmt::format_string<Values...> what,
                         Values&&... values) const {
    throw_at(where, fmt::format(what, std::forward<Values>(values)...));
  }

  template <typename... Values>
  [[noreturn]] void fail(fmt::format_string<Values...> what, Values&&... values) const {
    throw_at(table_, fmt::format(what, std::forward<Values>(values)...));
  }

  /// As a person writes it.
  [[nodiscard]] const std::string& title() const { return title_; }

  /// An unknown key is an error that names the nearest known one.
  void require_known(Names known) const;

  /// A key outside `own` is an error that names those that `owner`, as "law \"ogden\"",
  /// has. `shared` are keys that every owner has.
  void require_own(const std::string& owner, Names own, Names shared) const;

  [[nodiscard]] const toml::node* find(std::string_view key) const {
    return table_.get(key);
  }
  [[nodiscard]] const toml::node& need(std::string_view key) const;

  [[nodiscard]] double number(std::string_view key, const NumberRule& rule) const;
  [[nodiscard]] double number_or(double otherwise, std::string_view key,
                                 const NumberRule& rule) const;

  /// A text that is not empty.
  [[nodiscard]] std::string text(std::string_view key) const;

  /// A text that must be one of those that there are.
  [[nodiscard]] std::string choice(std::string_view key, Names available) const;

  [[nodiscard]] std::string choice_or(std::string_view otherwise, std::string_view key,
                                      Names available) const;

  [[nodiscard]] bool boolean_or(bool otherwise, std::string_view key) const;

  /// A whole number in [least, most].
  [[nodiscard]] int integer_or(int otherwise, std::string_view key, int least,
                               int most) const;

  /// [a, b, ...], 1 to `most` numbers.
  [[nodiscard]] std::vector<double> numbers(std::string_view key,
                                            const NumberRule& rule,
                                            std::size_t most) const;

  /// [x, y, z]; finite.
  [[nodiscard]] Eigen::Vector3d vector(std::string_view key) const;

  /// [[x, y, z], ...], 1 to `most` points; finite.
  [[nodiscard]] Points points(std::string_view key, std::size_t most) const;

  /// [x, y, z] of any length but 0, made a unit vector.
  [[nodiscard]] Eigen::Vector3d direction(std::string_view key) const;

  /// { ... } with known keys only.
  [[nodiscard]] SceneSection table(std::string_view key, Names known) const;

  /// The one of these keys that is there. @throws InputError for none and for several.
  [[nodiscard]] std::string_view only_one_of(Names keys) const;

  /// [[x, y, z], [x, y, z]], the lower corner first; finite [m].
  [[nodiscard]] Eigen::AlignedBox3d box(std::string_view key) const;

 private:
  [[noreturn]] void throw_at(const toml::node& where, const std::string& what) const;
  [[nodiscard]] double number_of(const toml::node& node, std::string_view key) const;
  [[nodiscard]] Eigen::Vector3d point(const std::string& what,
                                      const toml::node& node) const;

  const std::string& file_;
  std::string title_;
  const toml::table& table_;
};

}  // namespace palpate

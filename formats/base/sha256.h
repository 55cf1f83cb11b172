// SHA-256 of inputs and of database content, for provenance and integrity.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace palpate {

/// A SHA-256 digest that grows piece by piece.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void update(std::span<const std::byte> bytes);

  /// 64 lower-case hexadecimal digits of all bytes so far; more may follow.
  [[nodiscard]] std::string hex() const;

 private:
  struct State;  // OpenSSL's; PortableSha256 in a build without OpenSSL
  std::unique_ptr<State> state_;
};

/// 64 lower-case hexadecimal digits. @throws InputError if the file cannot be read.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace palpate

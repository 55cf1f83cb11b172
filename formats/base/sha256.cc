#include "formats/base/sha256.h"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#ifdef PALPATE_OPENSSL
#include <openssl/evp.h>
#endif

#include "formats/base/error.h"
#include "formats/base/portable_sha256.h"
#include "formats/base/utf8_path.h"

namespace palpate {

#ifdef PALPATE_OPENSSL
namespace {

// OpenSSL's digest calls fail only when the library is broken or out of memory.
void require_done(bool done) {
  if (!done) {
    throw std::runtime_error("OpenSSL could not compute a SHA-256 digest");
  }
}

}  // namespace

struct Sha256::State {
  using Context = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

  State() {
    require_done(context != nullptr &&
                 EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1);
  }
  void update(std::span<const std::byte> bytes) {
    require_done(EVP_DigestUpdate(context.get(), bytes.data(), bytes.size()) == 1);
  }
  [[nodiscard]] std::array<std::uint8_t, 32> digest() const {
    std::array<std::uint8_t, 32> result{};
    const Context copy(EVP_MD_CTX_new(), EVP_MD_CTX_free);
    require_done(copy != nullptr &&
                 EVP_MD_CTX_copy_ex(copy.get(), context.get()) == 1 &&
                 EVP_DigestFinal_ex(copy.get(), result.data(), nullptr) == 1);
    return result;
  }

  const Context context{EVP_MD_CTX_new(), EVP_MD_CTX_free};
};
#else
struct Sha256::State : PortableSha256 {};
#endif

Sha256::Sha256() : state_(std::make_unique<State>()) {}

Sha256::~Sha256() = default;

void Sha256::update(std::span<const std::byte> bytes) {
  state_->update(bytes);
}

std::string Sha256::hex() const {
  std::string text;
  for (const std::uint8_t byte : state_->digest()) {
    text += fmt::format("{:02x}", byte);
  }
  return text;
}

std::string sha256_of_file(const std::filesystem::path& file) {
  const auto fail = [&] {
    return InputError(fmt::format("{}: cannot be read: {}", utf8_of(file),
                                  std::strerror(errno == 0 ? EIO : errno)));
  };
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw fail();
  }
  Sha256 digest;
  std::array<char, 1 << 16> block{};
  do {
    in.read(block.data(), block.size());
    digest.update(
        std::as_bytes(std::span(block.data(), static_cast<std::size_t>(in.gcount()))));
  } while (in);
  if (!in.eof()) {
    throw fail();
  }
  return digest.hex();
}

}  // namespace palpate

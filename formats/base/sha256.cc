#include "formats/base/sha256.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// OpenSSL's digest calls fail only when the library is broken or out of memory.
void require_done(bool done) {
  if (!done) {
    throw std::runtime_error("OpenSSL could not compute a SHA-256 digest");
  }
}

}  // namespace

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  require_done(context_ != nullptr &&
               EVP_DigestInit_ex(context_, EVP_sha256(), nullptr) == 1);
}

Sha256::~Sha256() {
  EVP_MD_CTX_free(context_);
}

void Sha256::update(std::span<const std::byte> bytes) {
  require_done(EVP_DigestUpdate(context_, bytes.data(), bytes.size()) == 1);
}

std::string Sha256::hex() const {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_MD_CTX* copy = EVP_MD_CTX_new();
  const bool done = copy != nullptr && EVP_MD_CTX_copy_ex(copy, context_) == 1 &&
                    EVP_DigestFinal_ex(copy, digest.data(), &size) == 1;
  EVP_MD_CTX_free(copy);
  require_done(done);
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += fmt::format("{:02x}", digest[i]);
  }
  return text;
}

std::string sha256_of_file(const std::filesystem::path& file) {
  const auto fail = [&] {
    return InputError(fmt::format("{}: cannot be read: {}", file.string(),
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

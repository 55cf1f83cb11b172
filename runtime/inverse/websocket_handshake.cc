#include "runtime/inverse/websocket_handshake.h"

#include <array>
#include <random>
#include <span>

#include <openssl/evp.h>

namespace palpate {
namespace {

std::string base64(std::span<const unsigned char> bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   bytes.data(), static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

}  // namespace

std::optional<std::string> take_http_head(std::string& bytes) {
  const std::size_t end = bytes.find("\r\n\r\n");
  if (end == std::string::npos) {
    return std::nullopt;
  }
  std::string head = bytes.substr(0, end + 2);
  bytes.erase(0, end + 4);
  return head;
}

std::string http_field(const std::string& head, const std::string& name) {
  const std::size_t field = lower_case(head).find("\r\n" + name + ":");
  if (field == std::string::npos) {
    return "";
  }
  const std::size_t begin = head.find_first_not_of(" \t", field + name.size() + 3);
  const std::string value = head.substr(begin, head.find("\r\n", begin) - begin);
  return value.substr(0, value.find_last_not_of(" \t") + 1);
}

std::string lower_case(std::string text) {
  for (char& letter : text) {
    letter = static_cast<char>(letter >= 'A' && letter <= 'Z' ? letter | 0x20 : letter);
  }
  return text;
}

std::string websocket_key() {
  std::random_device random;
  std::array<unsigned char, 16> nonce{};
  for (unsigned char& byte : nonce) {
    byte = static_cast<unsigned char>(random());
  }
  return base64(nonce);
}

std::string websocket_accept(const std::string& key) {
  const std::string text = key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha1(), nullptr);
  return base64(std::span(digest).first(size));
}

}  // namespace palpate

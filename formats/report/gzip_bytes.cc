#include "formats/report/gzip_bytes.h"

#include <stdexcept>

#include <zlib.h>

namespace palpate {

std::vector<std::byte> gzip_bytes(std::span<const std::byte> bytes) {
  constexpr int kGzip = 16;  // with a header of gzip, without a time
  constexpr int kMemory = 9;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, kMemory,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::vector<std::byte> packed(deflateBound(&stream, bytes.size()));
  // zlib reads what it takes as not constant.
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int end = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (end != Z_STREAM_END) {
    throw std::logic_error("gzip: deflateBound() was too small");
  }
  return packed;
}

}  // namespace palpate

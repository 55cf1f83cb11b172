// The C interface's opening of bytes in memory.
#include "runtime/c_api/palpate_memory.h"

#include <cstddef>
#include <span>

#include "formats/base/error.h"
#include "runtime/c_api/given_options.h"
#include "runtime/c_api/guarded.h"
#include "runtime/c_api/host_handles.h"

palpate_body* palpate_open_memory(const void* bytes, size_t byte_count,
                                  const palpate_options* options, char* error,
                                  size_t error_bytes) {
  palpate::copy_text("", error, error_bytes);
  palpate_body* body = nullptr;
  palpate::guarded(error, error_bytes, [&] {
    if (bytes == nullptr) {
      throw palpate::InputError("no bytes are given: the pointer is null");
    }
    const std::span all(static_cast<const std::byte*>(bytes), byte_count);
    body = new palpate_body(palpate::StoredSource(all), palpate::host_options(options));
    return 0;
  });
  return body;
}

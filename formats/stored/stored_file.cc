#include "formats/stored/stored_file.h"

#include "formats/base/error.h"

namespace palpate {

void StoredFile::fail(const std::string& what) const {
  throw FormatError(name_ + ": " + what);
}

}  // namespace palpate

// Any bytes as a flat database, with a header whose digest is right: read, or refused
// with an Error, and by the reader of HDF5 likewise. For that the same objects are put
// into an HDF5 file: chunk by chunk both readers must agree on them, and what is read
// whole from the one must be read whole from the other.
#include <algorithm>
#include <stdexcept>
#include <string>

#include "formats/base/error.h"
#include "formats/database/chunk_reader.h"
#include "formats/database/database_layout.h"
#include "formats/flat/flat_directory.h"
#include "formats/hdf5/hdf5_file.h"
#include "formats/hdf5/hdf5_lock.h"
#include "tests/fuzz/input_file.h"

namespace {

using namespace palpate;

template <typename Read>
bool takes(const Read& read) {
  try {
    read();
    return true;
  } catch (const Error&) {
    return false;
  }
}

void read_chunks(const StoredSource& source) {
  const ChunkReader reader(source);
  for (std::int64_t k = 0; k < reader.index().chunks(); ++k) {
    (void)reader.body(k);
    for (std::size_t tool = 0; tool < reader.index().tools.size(); ++tool) {
      (void)reader.responses(tool, k);
    }
  }
}

// The bytes with a header that says what they are.
std::string repaired(std::string bytes) {
  FlatHeader header = read_flat_header(bytes);
  header.bytes = bytes.size();
  header.directory = std::min(header.directory, header.bytes);
  header.sha256 = flat_sha256(header, bytes.substr(header.directory));
  return bytes.replace(0, kFlatHeaderBytes, flat_header(header));
}

// Names that mean the same to HDF5: it has its own meaning for "." and "//".
bool is_plain(const std::string& path) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '/';
  };
  return path.size() > 1 && path[0] == '/' && path.back() != '/' &&
         path.find("//") == std::string::npos &&
         std::all_of(path.begin(), path.end(), plain);
}

void put_attribute(const std::string& path, const std::string& name,
                   const FlatAttribute& attribute, StoredSink& to) {
  const std::optional<StoredType> type = stored_type_of(attribute.kind);
  if (attribute.kind == FlatKind::kText) {
    to.text_attribute(path, name.c_str(), attribute.value);
  } else if (type && attribute.value.size() == bytes_of(*type)) {
    to.number_attribute(path, name.c_str(), *type, attribute.value.data());
  } else {
    throw std::runtime_error("HDF5 files of ours have no such attribute");
  }
}

// The objects of a flat file in an HDF5 one. @throws std::runtime_error where HDF5
// cannot have them.
void put_objects(const std::string& bytes, StoredSink& to) {
  const FlatHeader header = read_flat_header(bytes);
  for (const auto& [path, object] :
       read_flat_directory(header, std::string_view(bytes).substr(header.directory))) {
    if (path != "/" && !is_plain(path)) {
      throw std::runtime_error("HDF5 has a meaning of its own for it");
    }
    if (object.kind == FlatKind::kText) {
      to.text(path, {bytes.data() + object.offset, object.extent.front()});
    } else if (object.kind != FlatKind::kGroup) {
      to.dataset(path, *stored_type_of(object.kind),
                 {object.extent.begin(), object.extent.end()},
                 bytes.data() + object.offset);
    } else if (path != "/") {
      to.group(path);
    }
    for (const auto& [name, attribute] : object.attributes) {
      if (!is_plain("/" + name)) {
        throw std::runtime_error("no name of an attribute");
      }
      put_attribute(path, name, attribute, to);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = (skip_hdf5_exit_cleanup(), true);
  if (!quiet || size < kFlatFirstOffset) {
    return 0;
  }
  const std::string bytes =
      repaired(std::string(reinterpret_cast<const char*>(data), size));
  const StoredSource flat(std::as_bytes(std::span(bytes)));
  ResponseDatabase database;
  const bool whole = takes([&] {
    database = read_in_file_order(flat);
  });
  const bool streamed = takes([&] {
    read_chunks(flat);
  });
  std::unique_ptr<StoredSink> sink = make_hdf5_sink(false);
  StoredSink& objects = *sink;
  StoredWriter writer(std::move(sink));
  try {
    put_objects(bytes, objects);
    if (whole) {
      content::exchange_vtk(writer, database);
    }
  } catch (const Error&) {
    if (whole || streamed) {
      __builtin_trap();
    }
    return 0;
  } catch (const std::runtime_error&) {
    return 0;  // HDF5 cannot have these objects
  }
  const StoredSource hdf5(writer.image());
  const bool same_chunks = streamed == takes([&] {
                             read_chunks(hdf5);
                           });
  const bool same_whole = !whole || takes([&] {
    (void)read_in_file_order(hdf5);
  });
  if (!same_chunks || !same_whole) {
    __builtin_trap();
  }
  return 0;
}

#include "formats/response_database.h"

#include <fmt/format.h>

#include "formats/atomic_file.h"
#include "formats/database_content.h"
#include "formats/error.h"
#include "formats/hdf5_io.h"

namespace palpate {
namespace {

constexpr const char* kFormatName = "palpate-response-database";
constexpr const char* kDigestName = "content_sha256";

// Tool names in the order of the database: groups themselves are not ordered.
std::string join_names(const std::vector<ResponseTable>& tools) {
  std::vector<std::string> names;
  for (const ResponseTable& table : tools) {
    names.push_back(table.tool.name);
  }
  return content::join_lines(names);
}

void read_version(Hdf5Reader& file, const std::string& name) {
  std::string format;
  std::int64_t major = 0;
  std::int64_t minor = 0;
  if (!file.has_attribute("/", "format")) {
    throw FormatError(fmt::format(
        "{}: is an HDF5 file of another kind: attribute /@format is missing, must be "
        "\"{}\"",
        name, kFormatName));
  }
  file.attribute("/", "format", format);
  if (format != kFormatName) {
    throw FormatError(
        fmt::format("{}: is an HDF5 file of another kind: /@format is {:?}, must be "
                    "\"{}\"",
                    name, format.substr(0, 80), kFormatName));
  }
  file.attribute("/", "format_version", major);
  if (major != kDatabaseVersion) {
    throw FormatError(fmt::format("{}: has format version {}, this program reads {}{}",
                                  name, major, kDatabaseVersion,
                                  major > kDatabaseVersion ? "; use a newer one" : ""));
  }
  file.attribute("/", "format_version_minor", minor);
  if (minor < 0) {
    throw FormatError(fmt::format("{}: /@format_version_minor is {}, must be 0 or more",
                                  name, minor));
  }
}

}  // namespace

void write_database(const std::filesystem::path& file,
                    const ResponseDatabase& database) {
  check(database);
  AtomicFile atomic(file);
  Hdf5Writer out;
  out.attribute("/", "format", std::string(kFormatName));
  out.attribute("/", "format_version", std::int64_t{kDatabaseVersion});
  out.attribute("/", "format_version_minor", std::int64_t{kDatabaseVersionMinor});
  out.attribute("/", "writer", database.provenance.writer);
  content::exchange_rest(out, database);
  out.group("/tools");
  out.attribute("/tools", "names", join_names(database.tools));
  for (const ResponseTable& table : database.tools) {
    content::exchange_tool(out, "/tools/" + table.tool.name, table);
  }
  content::exchange_vtk(out, database);
  out.attribute("/", kDigestName, out.digest());
  atomic.write(out.image());
  atomic.commit();
}

ResponseDatabase read_database(const std::filesystem::path& file) {
  Hdf5Reader in(file);
  read_version(in, file.string());
  ResponseDatabase database;
  in.attribute("/", "writer", database.provenance.writer);
  content::exchange_rest(in, database);
  std::string names;
  in.group("/tools");
  in.attribute("/tools", "names", names);
  for (const std::string& name : content::split_lines(names)) {
    ResponseTable& table = database.tools.emplace_back();
    table.tool.name = name;
    content::exchange_tool(in, "/tools/" + name, table);
  }
  const std::string computed = in.digest();
  std::string stored;
  in.attribute("/", kDigestName, stored);
  // What breaks a rule says more than a digest that differs, so the rules come first.
  try {
    check(database);
  } catch (const FormatError& error) {
    throw FormatError(fmt::format("{}: {}", file.string(), error.what()));
  }
  if (stored != computed) {
    throw FormatError(
        fmt::format("{}: content has SHA-256 {}, must be {:?} as /@{} says: the file "
                    "was damaged or changed",
                    file.string(), computed, stored.substr(0, 64), kDigestName));
  }
  // Last, because it compares with what the rules have made safe.
  content::exchange_vtk(in, database);
  return database;
}

const ResponseTable& find_tool(const ResponseDatabase& database,
                               const std::string& name) {
  std::string known;
  for (const ResponseTable& table : database.tools) {
    if (table.tool.name == name || (name.empty() && database.tools.size() == 1)) {
      return table;
    }
    known += (known.empty() ? "" : ", ") + table.tool.name;
  }
  throw InputError(name.empty()
                       ? fmt::format("a tool must be named; there are: {}", known)
                       : fmt::format("unknown tool {:?}; there are: {}", name, known));
}

}  // namespace palpate

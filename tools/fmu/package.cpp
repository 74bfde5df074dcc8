#include "tools/fmu/package.h"

#include <archive.h>
#include <archive_entry.h>

#include <memory>
#include <stdexcept>

namespace slewlab::tools::fmu {
namespace {

// 1 January 1980, noon: the first day that a zip file can tell.
constexpr std::time_t kDate = 315'576'000;

void check(archive* zip, int result, const std::filesystem::path& path) {
  if (result == ARCHIVE_OK) return;
  const char* reason = archive_error_string(zip);
  throw std::runtime_error(path.string() + " cannot be written: " + (reason != nullptr ? reason : "an error of libarchive"));
}

}  // namespace

void write_package(const std::filesystem::path& path, const std::vector<PackedFile>& files) {
  const std::filesystem::path unfinished = path.string() + ".partial";
  try {
    const std::unique_ptr<archive, int (*)(archive*)> zip(archive_write_new(), archive_write_free);
    if (zip == nullptr) throw std::runtime_error(path.string() + ": no memory");
    check(zip.get(), archive_write_set_format_zip(zip.get()), path);
    check(zip.get(), archive_write_set_options(zip.get(), "zip:compression=deflate"), path);
    check(zip.get(), archive_write_open_filename(zip.get(), unfinished.c_str()), path);
    for (const PackedFile& file : files) {
      const std::unique_ptr<archive_entry, void (*)(archive_entry*)> entry(archive_entry_new(), archive_entry_free);
      archive_entry_set_pathname(entry.get(), file.name.c_str());
      archive_entry_set_size(entry.get(), static_cast<la_int64_t>(file.content.size()));
      archive_entry_set_filetype(entry.get(), AE_IFREG);
      archive_entry_set_perm(entry.get(), file.is_program ? 0755 : 0644);
      archive_entry_set_mtime(entry.get(), kDate, 0);
      check(zip.get(), archive_write_header(zip.get(), entry.get()), path);
      if (archive_write_data(zip.get(), file.content.data(), file.content.size()) != static_cast<la_ssize_t>(file.content.size())) {
        check(zip.get(), ARCHIVE_FATAL, path);
      }
    }
    check(zip.get(), archive_write_close(zip.get()), path);
    std::filesystem::rename(unfinished, path);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    throw;
  }
}

}  // namespace slewlab::tools::fmu

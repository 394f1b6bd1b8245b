#include "base/part_file.h"

#include <cerrno>
#include <cstring>
#include <system_error>

namespace vismap {
namespace {

std::filesystem::path PartOf(const std::filesystem::path& path) { return path.string() + ".part"; }

}  // namespace

Result<PartFile> PartFile::Create(const std::filesystem::path& path) {
  const std::filesystem::path part = PartOf(path);
  File file(std::fopen(part.c_str(), "wb"));
  if (!file) return Fail(part.string() + ": cannot write: " + std::strerror(errno));
  return PartFile(path, std::move(file));
}

PartFile::~PartFile() {
  if (!file_) return;
  std::error_code ignored;
  std::filesystem::remove(PartOf(path_), ignored);
}

void PartFile::Write(std::span<const uint8_t> bytes) {
  if (bytes.empty()) return;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size() && error_ == 0)
    error_ = errno;
}

Result<void> PartFile::Finish() {
  if (std::fflush(file_.get()) != 0 && error_ == 0) error_ = errno;
  const std::filesystem::path part = PartOf(path_);
  if (error_ != 0) return Fail(part.string() + ": cannot write: " + std::strerror(error_));
  std::error_code failed;
  std::filesystem::rename(part, path_, failed);
  if (failed)
    return Fail(path_.string() +
                ": cannot rename the finished file to this name: " + failed.message());
  file_.reset();
  return {};
}

}  // namespace vismap
